"""The plant's state as messages of the contract."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_contract import stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import battery_state, contact_cloud, wrench_stamped
from sojourn_contract.run_table import STORE
from sojourn_contract.topics import STANDARD, topic
from sojourn_contract.values import Clock, DiagnosticArray, JointState, Odometry
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.actuators.drive_condition import WINDING
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
        self._loads = tuple(load.name for load in model.loads)
        things = STANDARD.for_things({STORE: tuple(model.power.params.all_stores)})
        self._stores = tuple(row.name for row in things.each("/truth/electrical"))
        self._wrist_frame = model.machine.wrench_sensor_link or ""

    def first(self, stamp: int, state: PlantState) -> Iterator[tuple[str, Any]]:
        """Truth before the first step, with the forces of the settled machine as they were last seen."""
        model = self._model
        output = PlantOutput(
            contacts=model.report.copy(),
            efforts=model.efforts.copy(),
            currents=model.currents.copy(),
            power=model.power.at_rest(state.power),
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
            yield from self._store_messages(stamp, state, output)
        yield "/truth/odom", _odometry(stamp, state, output)
        yield "/truth/wrist_wrench", wrench_stamped(stamp, self._wrist_frame, output.wrist_wrench)
        yield "/truth/joint_states", self._joint_message(stamp, state, rates, output.efforts)
        yield "/truth/motor_states", self._motor_message(stamp, state, output)
        yield "/clock", Clock(stamp)
        yield "/truth/contacts", contact_cloud(stamp, output.contacts)
        if seldom:
            yield "/truth/loads", self._load_message(stamp, state, output)

    def _store_messages(self, stamp: int, state: PlantState, output: PlantOutput) -> Iterator[tuple[str, Any]]:
        network = self._model.power
        for name, store, of_store, bus, current in zip(
            self._stores,
            network.stores,
            state.power.stores,
            network.store_bus,
            output.power.store_currents,
            strict=True,
        ):
            soc, capacity = of_store.soc, store.charge_capacity
            measured = state.power.voltages[bus], current, of_store.temperature
            yield name, battery_state(stamp, *measured, soc, soc * capacity, capacity)

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
        values = {
            f"power {name}": f"{power:.6g}" for name, power in zip(self._loads, output.power.load_power, strict=True)
        }
        calm = self._model.air is None
        for name in state.energy.__dataclass_fields__:
            if calm and name == "air_work":
                continue
            values[f"energy {name}"] = f"{getattr(state.energy, name):.9g}"
        values |= self._network_values(state, output) | self._fuses(state) | self._temperatures(state)
        if self._model.machine.floats:
            values |= _momentum(self._model, state)
        if state.tool is not None and state.tool.has_worked:
            values |= {name: f"{value:.9g}" for name, value in state.tool.report().items()}
        return status_message(stamp, "loads", values)

    def _fuses(self, state: PlantState) -> dict[str, str]:
        """Of the loads that have one."""
        fuses = state.power.fuses
        if fuses is None:
            return {}
        loads = zip(self._model.loads, fuses.blown, strict=True)
        return {f"fuse {load.name}": "open" if blown else "closed" for load, blown in loads if load.fuse is not None}

    def _temperatures(self, state: PlantState) -> dict[str, str]:
        """Of the nodes of a machine whose heat is known, and of the windings of motors whose heat is [K]."""
        model, values = self._model, dict[str, str]()
        if model.heat is not None and state.heat is not None:
            nodes = zip(model.heat.machine.network.names, state.heat.nodes.thermal.temperatures, strict=True)
            values = {f"temperature {name}": f"{kelvin:.6g}" for name, kelvin in nodes}
        if model.conditions is not None and state.conditions is not None:
            drives = zip(model.conditions.rows, model.conditions.thermal, state.conditions[WINDING], strict=True)
            motors = [(model.joints.names[row], kelvin) for row, thermal, kelvin in drives if thermal is not None]
            values |= {f"winding {joint}": f"{kelvin:.6g}" for joint, kelvin in motors}
        return values

    def _network_values(self, state: PlantState, output: PlantOutput) -> dict[str, str]:
        """Of a network that is more than one battery: power of each source, and the account of the buses."""
        network = self._model.power
        if len(network.stores) == 1 and not (network.sources or network.converters):
            return {}
        powers = zip(network.params.sources, output.power.source_powers, strict=True)
        values = {f"source {name}": f"{power:.6g}" for name, power in powers}
        account = state.power.energy
        return values | {f"network {name}": f"{getattr(account, name):.9g}" for name in account._fields}


def _momentum(model: PlantModel, state: PlantState) -> dict[str, str]:
    """Of all links in map, linear [N s] and angular about their centre of mass [N m s]."""
    found = pin.computeCentroidalMomentum(model.multibody, model.data, state.configuration, state.velocity)
    return {
        f"{name} {axis}": f"{value:.6g}"
        for name, values in (("momentum", found.linear), ("angular momentum", found.angular))
        for axis, value in zip("xyz", values, strict=True)
    }


def _odometry(stamp: int, state: PlantState, output: PlantOutput) -> Odometry:
    configuration, velocity = state.configuration, state.velocity
    spread = np.zeros(SPREAD_SIZE * SPREAD_SIZE)
    spread[:: SPREAD_SIZE + 1] = output.spread[:SPREAD_SIZE] ** 2
    pose, twist = (configuration[:3], configuration[3:7]), (velocity[:3], velocity[3:6])
    return Odometry(stamp, "map", "base_link", *pose, *twist, twist_covariance=spread)
