"""The sensors without ROS: truth in, measurements out, from the sensors that the machine's file names."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import NOTHING, Answer, App, Period, Refusal
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.kept_data import Kept
from sojourn_contract.messages import battery_state, wrench_stamped
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_types import Topic
from sojourn_contract.unfinished_image import finished
from sojourn_contract.values import JointState, Odometry
from sojourn_machine.errors import MachineError
from sojourn_machine.evolution import replace
from sojourn_machine.sensor_fault import SensorFault
from sojourn_sensors.absent import absent_kinds
from sojourn_sensors.fault_hooks import FaultyState
from sojourn_sensors.faults import SensorFaults
from sojourn_sensors.memory import SensorsRestart, SensorsState
from sojourn_sensors.restart import begun, kept_values, started_again
from sojourn_sensors.sensor import Sensor, SensorSite, Truth
from sojourn_sensors.supply import LOADS, without_power
from sojourn_sensors.timing import LateReading, timing_of


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
        self._timings = [timing_of(sensor.rows, sensor.every) for sensor in self.sensors]
        self._on_demand = [sensor for sensor in self.sensors if sensor.params.on_demand]
        self._all_unheard = frozenset(sensor.name for sensor in self._on_demand)
        self._is_timed = any(timing is not None for timing in self._timings)
        """Whether anything is told later than it is measured."""
        self._faults = SensorFaults(self.sensors, self._at_rest)
        scheduled = [fault for fault in scenario.config.faults if isinstance(fault, SensorFault)]
        self._faults.check_tables(scheduled)
        self._absent = absent_kinds(self._table, [sensor.rows for sensor in self.sensors])

    def warm_up(self) -> None:
        """Every sensor reads twice: the first reading begins, the others go on."""
        truth = self._at_rest()
        for sensor in self.sensors:
            state = sensor.initial_state(truth)
            for _ in range(2):
                state, reading = sensor.step(state, truth, stamps.CONTROL_PERIOD_S)
                finished(reading)

    def initial_state(self) -> SensorsState:
        """Before the first truth."""
        return SensorsState(faulty=self._faults.initial_state(), off=self._all_unheard)

    def check(self, row: Topic, message: Any) -> None:
        """Refuse faults that no sensor can have."""
        if row.name == FAULTS_TOPIC:
            self._faults.check(message)

    def to_keep(self, state: SensorsState) -> dict[str, Any]:
        """What the sensors themselves are, whichever process reads them."""
        return kept_values(self.sensors, self._faults, state)

    def started_again(self, state: SensorsState, stamp: int, kept: Kept | None) -> SensorsState:
        """With what is wrong with the sensors as with those before."""
        return started_again(self._faults, state, stamp, kept)

    def heartbeat_values(self, state: SensorsState, stamp: int) -> dict[str, str]:
        """Faults that have come during the run, and that it is not the run's first process."""
        tables = {name for sensor in self.sensors for name in sensor.params.faults}
        names = [name for one in state.faulty.values() for name, _ in one.faults if name not in tables]
        values = {"faults": ", ".join(names)} if names else {}
        return values if state.restart is None else values | {"alarm": state.restart.alarm}

    def on_new_time(self, state: SensorsState) -> SensorsState:
        """The time since the last truth is not known."""
        return replace(state, measured_at=0)

    def step(self, state: SensorsState, period: Period) -> tuple[SensorsState, Answer]:
        """Measure the truth of this period."""
        if period.goals:
            said = {sensor.name: reading for sensor, reading in zip(self.sensors, state.readings, strict=False)}
            said = {name: reading for name, reading in said.items() if name not in state.dead}
            state = replace(state, faulty=self._faults.after(state.faulty, period.goals, period.stamp, said))
        loads = period.inputs.get(LOADS)
        if loads is not None:
            state = replace(state, dead=without_power(self.params.powered_by, state.dead, loads))
        if self._on_demand:
            off = self._unheard(period.wanted)
            state = state if off == state.off else replace(state, off=off)
        state, refusals = self._measure(state, period)
        if state.sensors is None:  # nothing has been measured yet
            return state, Answer(refusals=refusals) if refusals else NOTHING
        awake = [both for both in zip(self.sensors, state.readings, strict=True) if both[0].name not in state.off]
        late: Mapping[str, Sequence[LateReading]] = {}
        if self._is_timed:
            state, late = self._told(state, period.stamp // stamps.CONTROL_PERIOD_NS)
        return state, Answer(self._messages(awake, late, period), refusals)

    def _unheard(self, wanted: Collection[str]) -> frozenset[str]:
        """Sensors on demand none of whose topics is wanted."""
        if not wanted:
            return self._all_unheard
        return frozenset(one.name for one in self._on_demand if not any(row.name in wanted for row in one.rows))

    def _measure(self, state: SensorsState, period: Period) -> tuple[SensorsState, list[Refusal]]:
        """What the sensors say of a period; where its truth cannot be used what they said last, if anything."""
        stamp, inputs = period.stamp, period.inputs
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        if odometry is None or joints is None:  # refused on arrival
            return state, []
        truth, number = Truth(stamp, odometry, joints, inputs), stamp // stamps.CONTROL_PERIOD_NS
        dt = (stamp - state.measured_at) * 1e-9 if state.measured_at else stamps.CONTROL_PERIOD_S
        try:
            first = state if state.sensors is not None else begun(self.sensors, state, truth)
            after, readings = list(first.sensors or ()), list(first.readings)
            for place, sensor in enumerate(self.sensors):
                if sensor.name in state.off and not sensor.params.heard_rows:
                    after[place] = None  # it begins anew when somebody listens
                elif sensor.name not in state.off and self._measures(place, number, state.restart):
                    before = sensor.initial_state(truth) if after[place] is None else after[place]
                    read = sensor.step_without_power if sensor.name in state.dead else sensor.step
                    after[place], readings[place] = read(before, truth, dt)
                elif sensor.params.heard_rows:
                    after[place] = sensor.hear(after[place], truth)
        except (MachineError, RefusedMessageError) as error:
            return state, [("/truth/joint_states", str(error))]
        faulty = self._fault(first, readings, stamp) if first.faulty else first.faulty
        return replace(first, sensors=tuple(after), readings=tuple(readings), faulty=faulty, measured_at=stamp), []

    def _measures(self, place: int, number: int, restart: SensorsRestart | None) -> bool:
        """Whether a sensor measures in a control period; see `Timing.lost` for the first after a restart."""
        timing, every = self._timings[place], self.sensors[place].every
        if timing is None:
            return number % every == 0
        return timing.measures(number) or (restart is not None and number == restart.number)

    def _fault(self, state: SensorsState, readings: list[Any], stamp: int) -> Mapping[str, FaultyState]:
        """Put faults on the readings that are of this stamp [ns]; the state of the faults after it. What a sensor says
        without power is said whatever is wrong with it.
        """
        faulty, number = dict(state.faulty), stamp // stamps.CONTROL_PERIOD_NS
        for place, sensor in enumerate(self.sensors):
            if sensor.name not in faulty or sensor.name in state.off or sensor.name in state.dead:
                continue
            if self._measures(place, number, state.restart):
                hook = self._faults.hooks[sensor.name]
                faulty[sensor.name], readings[place] = hook.step(faulty[sensor.name], readings[place], stamp)
        return faulty

    def _told(self, state: SensorsState, number: int) -> tuple[SensorsState, Mapping[str, Sequence[LateReading]]]:
        """What of late readings is told in a control period, by sensor, and the state in which the others wait."""
        told: dict[str, Sequence[LateReading]] = {}
        rest: dict[str, Sequence[LateReading]] = {}
        for sensor, timing, reading in zip(self.sensors, self._timings, state.readings, strict=True):
            if timing is not None and sensor.name not in state.off:
                waiting = timing.with_reading(state.waiting.get(sensor.name, ()), number, reading)
                if state.restart is not None:
                    waiting = [*timing.lost(state.restart.number, number, reading), *waiting]
                told[sensor.name] = [one for one in waiting if one.leaves <= number]
                rest[sensor.name] = tuple(one for one in waiting if one.leaves > number)
        return replace(state, waiting=rest), told

    def _messages(
        self,
        readings: Sequence[tuple[Sensor[Any, Any, Any], Any]],
        late: Mapping[str, Sequence[LateReading]],
        period: Period,
    ) -> Iterator[tuple[str, Any]]:
        number = period.stamp // stamps.CONTROL_PERIOD_NS
        for sensor, reading in readings:
            if sensor.name in late:
                for one in late[sensor.name]:
                    yield from _said(sensor, one.measured * stamps.CONTROL_PERIOD_NS, one.reading, one.topics)
                continue
            due = [row.name for row in sensor.rows if is_due(row, number)]
            if due and _all_new(sensor.speaks_with, period.inputs):
                yield from _said(sensor, period.stamp, reading, due)
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


def _said(sensor: Sensor[Any, Any, Any], stamp: int, reading: Any, due: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """Of what a sensor says of a reading that was measured at a stamp [ns] what is due now."""
    return ((name, message) for name, message in sensor.messages(stamp, reading) if name in due)


def _all_new(topics: tuple[str, ...], inputs: Mapping[str, Any]) -> bool:
    return all(inputs.get(name) is not None for name in topics)
