"""The plant's state as messages of the contract."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import battery_state, contact_cloud, wrench_stamped
from sojourn_contract.topics import topic
from sojourn_contract.values import Clock, DiagnosticArray, JointState, Odometry
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.actuators.joint_drive import MOTOR_RATE
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantOutput, PlantState

SPREAD_SIZE = 6
"""Rows of the covariance of a twist."""


class TruthMessages:
    """Builds the truth of a period."""

    def __init__(self, model: PlantModel) -> None:
        self._model = model
        self._joints = (*model.joints.names, *(() if model.tool is None else (TOOL_JOINT,)))
        self._with_play = np.flatnonzero(model.joints.rotors)
        self._motors = tuple([model.joints.names[i] for i in self._with_play])
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
        yield "/truth/odom", _odometry(stamp, state, output)
        yield "/truth/wrist_wrench", wrench_stamped(stamp, self._wrist_frame, output.wrist_wrench)
        yield "/truth/joint_states", self._joint_message(stamp, state, rates, output.efforts)
        yield "/truth/motor_states", self._motor_message(stamp, state, output)
        yield "/clock", Clock(stamp)
        yield "/truth/contacts", contact_cloud(stamp, output.contacts)
        if seldom:
            yield "/truth/loads", self._load_message(stamp, state, output)

    def _joint_message(self, stamp: int, state: PlantState, rates: FloatArray, efforts: FloatArray) -> JointState:
        angles, tool = state.joints[0], state.tool
        if tool is not None:
            angles, rates = np.append(angles, tool.position), np.append(rates, tool.rate)
            efforts = np.append(efforts, tool.effort)
        return JointState(stamp, self._joints, angles, rates, efforts)

    def _motor_message(self, stamp: int, state: PlantState, output: PlantOutput) -> JointState:
        joints, places = state.joints, self._with_play
        angles = state.motor_angles[places]
        return JointState(stamp, self._motors, angles, joints[MOTOR_RATE][places], output.efforts[places])

    def _load_message(self, stamp: int, state: PlantState, output: PlantOutput) -> DiagnosticArray:
        values = {f"power {name}": f"{power:.6g}" for name, power in zip(self._loads, output.load_power, strict=True)}
        for name in state.energy.__dataclass_fields__:
            values[f"energy {name}"] = f"{getattr(state.energy, name):.9g}"
        if state.tool is not None and state.tool.has_worked:
            values |= {name: f"{value:.9g}" for name, value in state.tool.report().items()}
        return status_message(stamp, "loads", values)


def _odometry(stamp: int, state: PlantState, output: PlantOutput) -> Odometry:
    configuration, velocity = state.configuration, state.velocity
    spread = np.zeros(SPREAD_SIZE * SPREAD_SIZE)
    spread[:: SPREAD_SIZE + 1] = output.spread[:SPREAD_SIZE] ** 2
    pose, twist = (configuration[:3], configuration[3:7]), (velocity[:3], velocity[3:6])
    return Odometry(stamp, "map", "base_link", *pose, *twist, twist_covariance=spread)
