"""All that an operator's desk watches of a run: its alarms, and one log of what has happened. State and step, no ROS.

watch = Watch(limits_of(scenario), table_of(scenario))
state = watch.initial_state()
state, events = watch.step(state, "/drive/status", message)       for every message of `watch.topics`
state, events = watch.acknowledge(state, stamp, "operator")
message = watch.message(state, stamp)                             for /alarms
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sojourn_config.extends import read_document
from sojourn_config.load import validate
from sojourn_config.machine_reader import ALARMS
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.heartbeat import ENDED, STALLED, read_heartbeats
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import seconds
from sojourn_contract.topic_table import CLOCK, TopicTable
from sojourn_contract.topic_types import ROLES
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus, Message
from sojourn_operator.alarms.engine import Alarm, AlarmEngine, AlarmState, shown_value
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.narrator import HEARTBEATS, Narrator, NarratorState
from sojourn_operator.alarms.params import AlarmParams, AlarmSet, Severity
from sojourn_operator.alarms.usual import usual_limits

TOPIC = "/alarms"
LEVELS = {Severity.WATCH: 1, Severity.WARNING: 1, Severity.CRITICAL: 2}
"""Of a DiagnosticStatus: warning, error."""


@dataclass(frozen=True)
class WatchState:
    """Of the alarms, and what has been told.

    Args:
        now: stamp of the latest message [ns]. has_ended: whether whoever keeps the time has said that the run has.
    """

    alarms: AlarmState
    told: NarratorState
    now: int = 0
    has_ended: bool = False


class Watch:
    """Of one run.

    Args:
        limits: alarms by name. table: the topics of the run.

    Raises:
        UnknownFieldNameError: an alarm of a field that no message of the run has.
    """

    def __init__(self, limits: Mapping[str, AlarmParams], table: TopicTable) -> None:
        self.engine, self.narrator = AlarmEngine(limits, table), Narrator(table)
        self.table, self.keeper = table, table.topic(CLOCK).publisher
        """`keeper` is the role that keeps the time."""

    @property
    def topics(self) -> tuple[str, ...]:
        """That it wants to hear, each once."""
        return tuple(dict.fromkeys((*self.engine.topics, *self.narrator.topics)))

    def initial_state(self) -> WatchState:
        """Before the first message."""
        return WatchState(self.engine.initial_state(), self.narrator.initial_state())

    def step(self, state: WatchState, topic: str, message: Message) -> tuple[WatchState, list[Event]]:
        """Hear a message; the next state, and what has happened."""
        if topic in self.narrator.goals and not message.stamp:
            message = message._replace(stamp=state.now)  # zero means now, to whoever it is for
        has_ended = state.has_ended
        if topic == HEARTBEATS:
            beats = read_heartbeats(message)
            if not any(beat.role in ROLES for beat in beats):
                message = message._replace(stamp=state.now)  # of somebody's driver, by whatever clock
            if has_ended and any(beat.state == STALLED for beat in beats):
                return state, []  # for a moment, at every end in real time: they wait for who has ended
            has_ended = next((beat.state == ENDED for beat in beats if beat.role == self.keeper), has_ended)
        told, said = self.narrator.step(state.told, topic, message)
        alarms, raised = self.engine.step(state.alarms, topic, message)
        return WatchState(alarms, told, max(state.now, message.stamp), has_ended), [*said, *raised]

    def acknowledge(self, state: WatchState, who: str, keys: Iterable[str] = ()) -> tuple[WatchState, list[Event]]:
        """Somebody has seen these alarms, all where none is named. Raises KeyError for one that is not shown."""
        alarms, events = self.engine.acknowledge(state.alarms, state.now, who, keys)
        return replace(state, alarms=alarms), events

    def message(self, state: WatchState) -> DiagnosticArray:
        """What /alarms says: a status for each alarm that is shown, the worst first."""
        return DiagnosticArray(state.now, tuple(self._status(alarm) for alarm in state.alarms.shown))

    def _status(self, alarm: Alarm) -> DiagnosticStatus:
        params = self.engine.limits[alarm.name]
        values = {
            "severity": alarm.worst.word,
            "active": alarm.active.word,
            "acknowledged": alarm.acknowledged,
            "field": params.field + (f"[{alarm.label}]" if alarm.label else ""),
            "value": f"{alarm.value:.6g}" if isinstance(alarm.value, float) else alarm.value,
            "limit": str(params.levels[alarm.worst]),
            "since_s": f"{seconds(alarm.since):.3f}",
        }
        text = f"{alarm.word}: {shown_value(alarm.value)}" + (f", {params.help}" if params.help else "")
        return DiagnosticStatus(alarm.key, tuple(values.items()), text, LEVELS[alarm.worst])


def limits_of(scenario: LoadedScenario, file: Path | None = None) -> dict[str, AlarmParams]:
    """The alarms of a run: the usual ones of its machine, over them those of the machine's own `alarms.yaml`, over them
    those of a file. Raises ConfigError.
    """
    limits = usual_limits(scenario)
    own = scenario.documents.get(ALARMS)
    if own is not None:
        limits = validate(own, AlarmSet).over(limits)
    if file is not None:
        limits = validate(read_document(file, "parts"), AlarmSet).over(limits)
    AlarmEngine(limits, table_of(scenario))  # which looks for each field
    return limits
