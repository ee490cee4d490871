"""The sensors without ROS: truth in, measurements out, from the sensors that the machine's file names."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import NOTHING, Answer, App, Period
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import battery_state, wrench_stamped
from sojourn_contract.run_table import table_of
from sojourn_contract.values import JointState, Odometry
from sojourn_machine.errors import MachineError
from sojourn_machine.evolution import replace
from sojourn_sensors.absent import absent_kinds
from sojourn_sensors.sensor import Sensor, SensorSite, Truth
from sojourn_sensors.supply import LOADS, without_power


@dataclass(frozen=True, slots=True)
class SensorsState:
    """What the role remembers."""

    sensors: tuple[Any, ...] | None = None
    """State of each sensor; None until the first truth says which joints there are and how the machine stands."""
    readings: tuple[Any, ...] = ()
    """The last of each sensor, which is told again where the truth cannot be used; None without power."""
    dead: frozenset[str] = frozenset()
    """Sensors without power."""
    measured_at: int = 0
    """Stamp of the last truth that could be used [ns]; zero where it is not known."""


class SensorsApp(App[SensorsState]):
    """Role sensors."""

    role = "sensors"

    def __init__(self, scenario: LoadedScenario) -> None:
        self.params = scenario.sensors
        self._table = table_of(scenario)
        site = SensorSite(scenario, self._table)
        self.sensors: tuple[Sensor[Any, Any, Any], ...] = tuple(
            params.sensor(name, site) for name, params in self.params.sensors.items()
        )
        self._absent = absent_kinds(self._table, [sensor.rows for sensor in self.sensors])

    def warm_up(self) -> None:
        """Every sensor reads twice: the first reading begins, the others go on."""
        truth = self._at_rest()
        for sensor in self.sensors:
            state = sensor.initial_state(truth)
            for _ in range(2):
                state, _ = sensor.step(state, truth, stamps.CONTROL_PERIOD_S)

    def initial_state(self) -> SensorsState:
        """Before the first truth."""
        return SensorsState()

    def on_new_time(self, state: SensorsState) -> SensorsState:
        """The time since the last truth is not known."""
        return replace(state, measured_at=0)

    def step(self, state: SensorsState, period: Period) -> tuple[SensorsState, Answer]:
        """Measure the truth of this period."""
        loads = period.inputs.get(LOADS)
        if loads is not None:
            state = replace(state, dead=without_power(self.params.powered_by, state.dead, loads))
        state, refusals = self._measure(state, period)
        if state.sensors is None:  # nothing has been measured yet
            return state, Answer(refusals=refusals) if refusals else NOTHING
        return state, Answer(self._messages(state.readings, period), refusals)

    def _measure(self, state: SensorsState, period: Period) -> tuple[SensorsState, list[tuple[str, Exception]]]:
        """What the sensors say of a period; where its truth cannot be used what they said last, if anything."""
        stamp, inputs = period.stamp, period.inputs
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        if odometry is None or joints is None:  # refused on arrival
            return state, []
        truth, number = Truth(stamp, odometry, joints, inputs), stamp // stamps.CONTROL_PERIOD_NS
        dt = (stamp - state.measured_at) * 1e-9 if state.measured_at else stamps.CONTROL_PERIOD_S
        try:
            if state.sensors is None:
                after = [sensor.initial_state(truth) for sensor in self.sensors]
                readings: list[Any] = [None] * len(after)
            else:
                after, readings = list(state.sensors), list(state.readings)
            for place, sensor in enumerate(self.sensors):
                if number % sensor.every == 0:
                    read = sensor.step_without_power if sensor.name in state.dead else sensor.step
                    after[place], readings[place] = read(after[place], truth, dt)
        except (MachineError, RefusedMessageError) as error:
            return state, [("/truth/joint_states", error)]
        return SensorsState(tuple(after), tuple(readings), state.dead, stamp), []

    def _messages(self, readings: tuple[Any, ...], period: Period) -> Iterator[tuple[str, Any]]:
        number = period.stamp // stamps.CONTROL_PERIOD_NS
        for sensor, reading in zip(self.sensors, readings, strict=True):
            due = [row.name for row in sensor.rows if is_due(row, number)]
            if due and _all_new(sensor.speaks_with, period.inputs):
                for name, message in sensor.messages(period.stamp, reading):
                    if name in due:
                        yield name, message
        for row, kind in self._absent:
            if is_due(row, number):
                yield from kind.silence(period.stamp)

    def _at_rest(self) -> Truth:
        """A truth with every joint and every store, of a machine that stands."""
        groups = self.params.joint_groups.values()
        names = tuple(joint for group in groups for joint in group.joints)
        zeros = np.zeros(len(names))
        still = np.array([0.0, 0.0, 0.0, 1.0])
        stores = [row.name for row in self._table.each("/truth/electrical")]
        inputs: dict[str, Any] = {name: battery_state(0, 28.0, 1.0, 290.0, 1.0, 1.0, 1.0) for name in stores}
        inputs["/truth/wrist_wrench"] = wrench_stamped(0, "", np.zeros(6))
        odometry = Odometry(0, "map", "base_link", np.zeros(3), still, np.zeros(3), np.zeros(3))
        return Truth(0, odometry, JointState(0, names, zeros, zeros, zeros), inputs)


def _all_new(topics: tuple[str, ...], inputs: Mapping[str, Any]) -> bool:
    return all(inputs.get(name) is not None for name in topics)
