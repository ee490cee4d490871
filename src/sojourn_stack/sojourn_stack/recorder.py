"""The recorder of a run without middleware: the same bag as that of the recorder's node."""

from collections import deque
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.completeness import Completeness
from sojourn_bags.onset import HEARTBEATS, TICK, TICK_PERIODS, Onset, Span, counted_by
from sojourn_bags.recorded_run import RecordedRun
from sojourn_bags.recording import RECORDER
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.codecs import encode
from sojourn_contract.disturbed_app import undisturbed
from sojourn_contract.heartbeat import RUNNING, beats, heartbeat_message
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import seconds
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_contract.unfinished_image import UnfinishedImage
from sojourn_contract.values import Message
from sojourn_stack.stack import StackState


def onset_of(state: StackState, scenario: LoadedScenario) -> Onset:
    """Of a record that begins where a run stands."""
    before: dict[str, int] = {}
    ahead = [name for name, _ in state.ahead]
    own = counted_by(state.leaps.before(state.period), state.leaps).published
    for published in (own, *(one.published for one in state.roles.values())):
        for name, count in published.items():
            before[name] = before.get(name, 0) + count
    counts = {row.name: before.get(row.name, 0) - ahead.count(row.name) for row in table_of(scenario)}
    return Onset(state.period, counts, state.leaps, _faults_before(state, scenario))


def _faults_before(state: StackState, scenario: LoadedScenario) -> dict[str, Span]:
    """Faults that have come by then, with when they came and went: those of the schedule, and those that somebody has
    sent besides and that are still there; of one of the plant it is not known since when.
    """
    operator, plant, sensors = (state.roles.get(role) for role in ("operator", "plant", "sensors"))
    found, sent = dict[str, Span](), dict[str, Span]()
    if operator is not None:
        begun, over = operator.app.faults.begun, operator.app.faults.over
        gone = {name: seconds(stamp) for name, stamp in over.items() if stamp <= state.now}
        found = {name: (seconds(stamp), gone.get(name)) for name, stamp in begun.items() if stamp <= state.now}
    # a role that is not ours keeps its state to itself
    if plant is not None:
        sent = {one.name: (0.0, None) for one in getattr(undisturbed(plant.app), "faults", ())}
    if sensors is not None:
        tables = {name for sensor in scenario.sensors.sensors.values() for name in sensor.faults}
        faulty = getattr(undisturbed(sensors.app), "faulty", {}).values()
        sent |= {name: (fault.after, None) for one in faulty for name, fault in one.faults if name not in tables}
    return sent | found


class DirectRecorder:
    """Takes what was said, and writes the bag.

    Args:
        folder: the bag; made here. run: that it is of.

    A record that begins within a run counts on from what the recorder of that run had counted. While an image is being
    made the recorder stays behind with that period and what follows.

    Raises:
        BagsError: it cannot be written. ConfigError: the scenario is wrong.
    """

    def __init__(self, folder: Path, run: RecordedRun) -> None:
        self._run = run
        self._counters = counted_by(run.onset.last, run.onset.leaps)
        self._recording = run.open(folder, self._refuse)
        self._now = run.onset.resumed_at
        self._behind = deque[Sequence[tuple[Topic, Message]]]()
        """What was said in periods that are not taken yet."""

    def take(self, said: Sequence[tuple[Topic, Message]]) -> None:
        """What was said in a period, in its order."""
        self._behind.append(said)
        while self._behind and _is_whole(self._behind[0]):
            self._take_period(self._behind.popleft())

    def finish(self) -> Completeness:
        """Write what is left and close the bag, with its account."""
        try:
            while self._behind:
                self._take_period(self._behind.popleft())
        finally:
            completeness = self._recording.finish(self._run.record())
        return completeness

    def _take_period(self, said: Sequence[tuple[Topic, Message]]) -> None:
        for row, message in said:
            if row.logged:
                self._take(row, message)
        while collected := self._recording.collect():
            before, self._now = self._now, collected
            if beats(before, collected):
                self._counters.count_published(HEARTBEATS)
                self._take(topic(HEARTBEATS), heartbeat_message(RECORDER, RUNNING, collected, self._counters))
        while period := self._recording.write_period():
            if period % TICK_PERIODS == 0:
                self._counters.count_published(TICK)
        self._recording.writer.flush_if_due()

    def _take(self, row: Topic, message: Message) -> None:
        self._recording.take(row, message.stamp, encode(row, message))

    def _refuse(self, name: str, reason: str) -> None:
        self._counters.count_refused(name, reason)


def _is_whole(said: Sequence[tuple[Topic, Message]]) -> bool:
    """Whether nothing that was said is still being made."""
    return all(message.is_finished for _, message in said if isinstance(message, UnfinishedImage))
