"""The faults of all sensors: those of their tables, and those that come and go by the messages of /faults."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from sojourn_config.errors import ConfigError, shown
from sojourn_contract import stamps
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.fault_messages import read_fault
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.unfinished_image import finished
from sojourn_machine.evolution import replace
from sojourn_machine.names import names_text
from sojourn_machine.sensor_fault import SensorFault
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_sensors.fault_hooks import FaultHook, FaultyState, changes_readings
from sojourn_sensors.sensor import Sensor, Truth

Faulty = Mapping[str, FaultyState]
"""By the names of the sensors that have faults."""


class SensorFaults:
    """Which sensors have which faults.

    Args:
        sensors: of the machine. at_rest: makes a truth for them, of a machine that stands.
    """

    def __init__(self, sensors: Sequence[Sensor[Any, Any, Any]], at_rest: Callable[[], Truth]) -> None:
        self._sensors = {sensor.name: sensor for sensor in sensors}
        self.hooks = {sensor.name: FaultHook(sensor) for sensor in sensors}
        self._at_rest = at_rest

    def initial_state(self) -> Faulty:
        """As the tables have it."""
        found = {name: self._in_table(name) for name in self._sensors}
        return {name: FaultyState(tuple(faults.items())) for name, faults in found.items() if faults}

    @property
    def names(self) -> frozenset[str]:
        """Of the sensors, whether they have faults or not."""
        return frozenset(self._sensors)

    def kept(self, faulty: Faulty) -> list[list[Any]]:
        """All faults as JSON has them: sensor, name and words of each."""
        return [
            [sensor, name, fault.model_dump(mode="json", exclude_defaults=True)]
            for sensor, state in faulty.items()
            for name, fault in state.faults
        ]

    def of_kept(self, values: Any) -> tuple[Faulty, list[str]]:
        """The faults that `kept` has made JSON of, and in words what is none that a sensor can have."""
        faulty, lost = dict[str, FaultyState](), list[str]()
        for each in values if isinstance(values, list) else [values]:
            try:
                sensor, name, words = each
                fault = SensorFaultParams.model_validate(words)
                if not (isinstance(name, str) and changes_readings(fault)):
                    raise ValueError(name)
                self._check(sensor, {name: fault})
            except (ConfigError, KeyError, TypeError, ValueError):
                lost.append(f"fault {shown(each)}")
                continue
            before = faulty.get(sensor, FaultyState(()))
            faulty[sensor] = replace(before, faults=(*before.faults, (name, fault)))
        return faulty, lost

    def check_tables(self, scheduled: Sequence[SensorFault]) -> None:
        """Raise ConfigError for a fault of a table, or of a schedule, that its sensor cannot have."""
        for name in self._sensors:
            if faults := self._in_table(name):
                self._check(name, faults)
        for fault in scheduled:
            self._check(fault.sensor, {fault.called: fault})

    def check(self, message: Any) -> None:
        """Raise RefusedMessageError for a fault of a sensor that it cannot have, or that others would have to know."""
        event = read_fault(message)
        fault = event.fault
        if not isinstance(fault, SensorFault):
            return
        if fault.sensor not in self._sensors:
            allowed = names_text(fault.sensor, self._sensors).removeprefix("allowed is ")
            raise RefusedMessageError(FAULTS_TOPIC, "sensor", fault.sensor, allowed)
        try:
            self._check(fault.sensor, {event.name: fault})
        except ConfigError as error:
            raise RefusedMessageError(FAULTS_TOPIC, fault.sensor, event.name, str(error)) from None

    def after(self, faulty: Faulty, goals: Sequence[tuple[str, Any]], stamp: int, said: Mapping[str, Any]) -> Faulty:
        """Those from a stamp on [ns]. What loses messages is not theirs: it is in the run's table of topics.

        Args:
            said: last reading of each sensor that has power, by its name: what one repeats that gets stuck now.
        """
        for topic, message in goals:
            if topic != FAULTS_TOPIC:
                continue
            event = read_fault(message)
            fault = event.fault
            if not isinstance(fault, SensorFault) or not changes_readings(fault):
                continue
            before = faulty.get(fault.sensor, FaultyState((), said.get(fault.sensor)))
            kept = tuple(one for one in before.faults if one[0] != event.name)
            now = ((event.name, fault.as_params(stamps.seconds(stamp))),) if event.comes else ()
            left = {name: state for name, state in faulty.items() if name != fault.sensor}
            faulty = {**left, fault.sensor: replace(before, faults=(*kept, *now))} if kept or now else left
        return faulty

    def _in_table(self, name: str) -> dict[str, SensorFaultParams]:
        faults = self._sensors[name].params.faults
        return dict(faults) if any(changes_readings(fault) for fault in faults.values()) else {}

    def _check(self, name: str, faults: Mapping[str, SensorFaultParams]) -> None:
        sensor, truth = self._sensors[name], self._at_rest()
        reading = sensor.step(sensor.initial_state(truth), truth, stamps.CONTROL_PERIOD_S)[1]
        self.hooks[name].check(faults, finished(reading))
