"""Node `recorder`: writes every logged topic as received, in a fixed order, and proves the bag complete.

In lock-step it takes part: it says on /recorder/tick up to which period everything is written, and the plant
never runs further ahead than the table allows. The file is the same from run to run. In real time it writes
what comes. Besides it shows the machine to viewers, see `live_model`.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rclpy.context import Context

from sojourn_bags.definitions import ChannelSpec, offered_entries
from sojourn_bags.errors import BagsError
from sojourn_bags.live_model import LiveModel
from sojourn_bags.onset import TICK, TICK_PERIODS, RecordBeginning, counted_by
from sojourn_bags.recorded_run import RecordedRun
from sojourn_bags.recording import CLOCK, Recording
from sojourn_bags.writer import FLUSH_REALTIME_S
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.codecs import encode
from sojourn_contract.decoding import stamp_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import STALLED
from sojourn_contract.node import ContractNode
from sojourn_contract.state_tree import CheckpointError, unpacked
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Header, Message

DRAIN_S = 2.0
"""Wall time without a message after which the recorder stops waiting for what is still missing."""


class RecorderNode(ContractNode):
    """The recorder. Its parameter `bag` is the folder to write, relative to the working folder; `beginning` a file with
    that of a record which begins within a run, "" for none.

    Args:
        context, overrides, namespace: as of every node. beginning: of a record which begins within a run; None: as the
            parameter says. loaded: the scenario, where it has been read.

    Raises BagsError at the start if the bag cannot be written, ConfigError if the scenario is wrong, CheckpointError if
    the file is none of a beginning.
    """

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
        beginning: RecordBeginning | None = None,
        loaded: LoadedScenario | None = None,
    ) -> None:
        self._recording: Recording | None = None
        self._loaded = loaded
        super().__init__("recorder", context=context, overrides=overrides, namespace=namespace)
        file = str(self.declare_parameter("beginning", "").value)
        begin = beginning or (_read_beginning(Path(file)) if file else RecordBeginning())
        self._onset = begin.onset
        self.goes_on_from = begin.onset.resumed_at
        self.counters = counted_by(begin.onset.last, begin.onset.leaps)
        if not self.lockstep:
            self._trigger = CLOCK
        folder = str(self.declare_parameter("bag", "").value)
        try:
            self.recording = self._recording = self._open(folder)
        except (BagsError, ConfigError):
            self.destroy_node()
            raise
        told = [row.name for row in self.table if row.publisher in self.participants]
        self._live = LiveModel(self, self.scenario, told)
        heard = {row.name: row for row in self.endpoints.inputs}
        for name, message in begin.ahead:
            if name in heard:
                self.hear(heard[name], message)

    def read_scenario(self, name: str, overrides: Sequence[str]) -> LoadedScenario:
        """See ContractNode."""
        return load_scenario(name, overrides) if self._loaded is None else self._loaded

    def poll(self) -> None:
        """Wall-clock chores: readiness, a word when stalled, and the flush."""
        self.recording.writer.flush_if_due()
        if not self.lockstep:
            self.recording.write_window()
        if self.now == 0 or not self.lockstep:
            super().poll()
            return
        now = time.monotonic()
        self.endpoints.bundles.look(now)
        if now - self._last_progress > self.timeout_s / 2:
            self._last_progress = now
            missing = self.recording.missing()
            if missing:
                role = missing[0].publisher
                detail = f"waiting for {missing[0].name} from {role}"
                self._send_heartbeat(STALLED, self.now, detail, {"waiting for role": role})

    def lacks(self, row: Topic, stamp: int) -> bool:
        """See ContractNode."""
        return self.recording.lacks(row, stamp)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Nothing: messages are written as their periods are released."""

    def is_drained(self) -> bool:
        """Whether everything that the others say they have sent is here, or nothing has come for a while."""
        self.recording.writer.flush_if_due()
        if self.now == 0 or time.monotonic() - self.recording.last_arrival > DRAIN_S:
            return True
        return self.recording.has_all()

    def close(self) -> None:
        """Write what is left, the account of the bag and its index; a gap makes the exit status 1."""
        self._finish()
        super().close()

    def destroy_node(self) -> None:
        """Leave a whole bag behind, however the run ended."""
        self._finish()
        super().destroy_node()

    def _open(self, folder: str) -> Recording:
        if not folder:
            raise BagsError("parameter 'bag' is empty: give the folder to write the bag into")
        recording = self._run().open(Path(folder), self.refuse, self._offered)
        if not self.lockstep:
            recording.writer.flush_s = FLUSH_REALTIME_S
        return recording

    def _offered(self, spec: ChannelSpec) -> list[dict[str, Any]]:
        """Profiles of those who publish a topic; none for what the recorder itself adds."""
        name = self.get_namespace().rstrip("/") + spec.topic
        return offered_entries(spec.qos, (info.qos_profile for info in self.get_publishers_info_by_topic(name)))

    def hear(self, row: Topic, message: Message) -> None:
        """Take what a neighbour says, as the bytes that it would send."""
        self._receive(row, encode(row, message))

    def _receive(self, row: Topic, message: bytes) -> None:
        """Take one message as bytes, and write it whatever it is: what is wrong with it, others will judge. What the
        recorder itself cannot read of it is counted as refused.
        """
        stamp = 0
        try:
            stamp = stamp_of(row.name, message)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))
        self._live.hear(row.name, stamp, message)
        self.recording.take(row, stamp, message)
        if not self.lockstep:
            if row.name == CLOCK:
                self._hear_clock(row, stamp)
            return
        while collected := self.recording.collect():
            self.act(collected, {})
            self._write_periods()  # each before the next: its heartbeat tells of the ticks
        self._write_periods()

    def _write_periods(self) -> None:
        """Write the periods of lock-step that are ready, and say so."""
        while period := self.recording.write_period():
            if period % TICK_PERIODS == 0:
                self.publish(TICK, Header(period * stamps.CONTROL_PERIOD_NS))

    def _hear_clock(self, row: Topic, stamp: int) -> None:
        """In real time the plant's clock paces the recorder, as far as it can be believed."""
        allowed = self._refusal_realtime(row, stamp)
        if allowed is not None:
            refusal = RefusedMessageError(row.name, "clock", f"{stamps.seconds(stamp):.3f} s", allowed)
            self.refuse(row.name, str(refusal))
            return
        self._silence.ends()
        self.recording.advance(self.latest.timeline.now)
        if stamp > self.now:
            self.act(stamp, {})

    def _run(self) -> RecordedRun:
        named = (self.scenario_name, self.scenario_overrides, self.participants)
        return RecordedRun(*named, self.lockstep, self.get_namespace(), self.scenario, self._onset)

    def _finish(self) -> None:
        """Close the bag, once."""
        recording, self._recording = self._recording, None
        if recording is None:
            return
        completeness = recording.finish(self._run().record())
        if completeness.gaps:
            self.exit_status = 1
            self.failure = f"the bag {recording.writer.folder} is not complete: {completeness.explain()}"
            self.get_logger().error(self.failure)


def _read_beginning(file: Path) -> RecordBeginning:
    begin = unpacked(file.read_bytes(), str(file))
    if not isinstance(begin, RecordBeginning):
        raise CheckpointError(str(file), f"a {type(begin).__name__}: allowed is the beginning of a record")
    return begin


def main() -> None:
    """Run the recorder as a process of its own."""
    try:
        sys.exit(process.run(RecorderNode))
    except (BagsError, ConfigError, CheckpointError, OSError) as error:
        print(f"recorder: {error}", file=sys.stderr)
        sys.exit(1)
