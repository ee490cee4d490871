"""The plant's state as messages of the contract."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock

from sojourn_contract import stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import (
    battery_state,
    contact_cloud,
    fill_contact_cloud,
    fill_joint_state,
    joint_state,
    set_quaternion,
    set_xyz,
    wrench_stamped,
)
from sojourn_contract.topics import topic
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.actuators.joint_drive import MOTOR_RATE
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantOutput, PlantState

SPREAD_SIZE = 6
"""Rows of the covariance of a twist."""


class TruthMessages:
    """Builds the truth of a period; keeps its message objects, which are filled anew each time."""

    def __init__(self, model: PlantModel) -> None:
        self._model = model
        self._joints = joint_state((*model.joints.names, *(() if model.tool is None else (TOOL_JOINT,))))
        self._with_play = np.flatnonzero(model.joints.rotors)
        self._motors = joint_state([model.joints.names[i] for i in self._with_play])
        self._contacts = contact_cloud()
        self._odometry = Odometry(child_frame_id="base_link")
        self._odometry.header.frame_id = "map"
        self._spread = np.zeros(SPREAD_SIZE**2)
        self._loads = tuple(load.name for load in model.bus.loads)
        self._wrist_frame = model.machine.wrench_sensor_link or ""

    def first(self, stamp: int, state: PlantState) -> Iterator[tuple[str, Any]]:
        """Truth before the first step, with the forces of the settled machine as they were last seen."""
        model = self._model
        output = PlantOutput(
            contacts=model.report.copy(),
            efforts=model.efforts.copy(),
            currents=model.currents.copy(),
            load_power=np.zeros(len(self._loads)),
            battery_current=0.0,
            spread=np.zeros_like(state.velocity),
            wrist_wrench=None if model.wrist is None else model.wrist.at_rest(state.configuration, model.report),
        )
        return self.messages(stamp, state, output)

    def messages(self, stamp: int, state: PlantState, output: PlantOutput) -> Iterator[tuple[str, Any]]:
        """Messages of one period as (topic, message): first those that the sensors wait for, so that they work
        while the others are made.
        """
        period = stamp // stamps.CONTROL_PERIOD_NS
        time = stamps.to_message(stamp)
        odometry = self._odometry
        odometry.header.stamp = time
        set_xyz(odometry.pose.pose.position, state.configuration[:3])
        set_quaternion(odometry.pose.pose.orientation, state.configuration[3:7])
        set_xyz(odometry.twist.twist.linear, state.velocity[:3])
        set_xyz(odometry.twist.twist.angular, state.velocity[3:6])
        self._spread[:: SPREAD_SIZE + 1] = output.spread[:SPREAD_SIZE] ** 2
        odometry.twist.covariance = self._spread
        rates = state.velocity[self._model.joints.columns]
        seldom = is_due(topic("/truth/electrical"), period)
        if seldom:
            battery = self._model.battery
            supply = state.battery
            yield (
                "/truth/electrical",
                battery_state(
                    stamp,
                    state.bus_voltage,
                    output.battery_current,
                    supply.temperature,
                    supply.soc,
                    supply.soc * battery.charge_capacity,
                    battery.charge_capacity,
                ),
            )
        yield "/truth/odom", odometry
        yield "/truth/wrist_wrench", wrench_stamped(stamp, self._wrist_frame, output.wrist_wrench)
        yield "/truth/joint_states", self._joint_message(stamp, state, rates, output.efforts)
        yield "/truth/motor_states", self._motor_message(stamp, state, output)
        yield "/clock", Clock(clock=time)
        yield "/truth/contacts", fill_contact_cloud(self._contacts, stamp, output.contacts)
        if seldom:
            yield "/truth/loads", self._load_message(stamp, state, output)

    def _joint_message(self, stamp: int, state: PlantState, rates: FloatArray, efforts: FloatArray) -> Any:
        message, tool = fill_joint_state(self._joints, stamp, state.joints[0], rates, efforts), state.tool
        if tool is not None:
            message.position.append(tool.position)
            message.velocity.append(tool.rate)
            message.effort.append(tool.effort)
        return message

    def _motor_message(self, stamp: int, state: PlantState, output: PlantOutput) -> Any:
        joints, places = state.joints, self._with_play
        return fill_joint_state(
            self._motors, stamp, state.motor_angles[places], joints[MOTOR_RATE, places], output.efforts[places]
        )

    def _load_message(self, stamp: int, state: PlantState, output: PlantOutput) -> Any:
        values = {f"power {name}": f"{power:.6g}" for name, power in zip(self._loads, output.load_power, strict=True)}
        for name in state.energy.__dataclass_fields__:
            values[f"energy {name}"] = f"{getattr(state.energy, name):.9g}"
        if state.tool is not None and state.tool.has_worked:
            values |= {name: f"{value:.9g}" for name, value in state.tool.told().items()}
        return status_message(stamp, "loads", values)
