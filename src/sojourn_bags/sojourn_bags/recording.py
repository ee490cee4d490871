"""A recording in progress: takes messages as bytes, writes them in order, adds /tf, accounts for them.

It knows messages but no node and no executor; the recorder node feeds it.
"""

import struct
import time
from collections.abc import Callable, Mapping, Sequence

from sojourn_bags.completeness import OUTSIDE_THE_RECORD, RECORD, Completeness, PublishedCounts, account
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.onset import WHOLE, Onset
from sojourn_bags.order import TICK, Entry, PeriodOrder, WindowOrder
from sojourn_bags.transforms import TransformSource
from sojourn_bags.writer import BagWriter
from sojourn_contract.codecs import decode
from sojourn_contract.decoding import refusing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import HEARTBEAT_PERIODS, read_heartbeats
from sojourn_contract.leaps import LeapWatch
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES

CLOCK, TRUTH, ODOMETRY = "/clock", "/truth/odom", "/odom"
RECORDER = "recorder"
"""The role that writes."""


class Recording:
    """What the recorder has taken and written so far.

    Args:
        writer: open bag, whose channels are `rows` and after them /tf.
        rows: topics that are recorded. awaited: those that lock-step waits for.
        participants: roles of the run. lockstep: mode of time.
        refuse: called with the topic and the reason for a message that is written and cannot be read.
        onset: where in the run the record begins. longest_leap: control periods by which the clock may leap.
    """

    def __init__(
        self,
        writer: BagWriter,
        rows: Sequence[Topic],
        awaited: Sequence[Topic],
        participants: Sequence[str],
        lockstep: bool,
        refuse: Callable[[str, str], None],
        onset: Onset = WHOLE,
        longest_leap: int = 0,
    ) -> None:
        self.writer = writer
        self._refuse = refuse
        self.lockstep = lockstep
        self.last_stamp = 0
        """Newest stamp of the plant's clock [ns], by which two of its messages have come."""
        self.last_arrival = time.monotonic()
        self._rows = tuple(rows)
        self._channel_of = {row.name: number for number, row in enumerate(self._rows)}
        self._awaited = tuple(awaited)
        ranks = frozenset(ROLES.index(role) for role in participants if role in ROLES)
        channels = [(self._channel_of[row.name], row) for row in self._awaited]
        self._onset = onset
        earlier = {channel: onset.before.get(name, 0) for name, channel in self._channel_of.items()}
        self._periods = PeriodOrder(channels, ranks, HEARTBEAT_PERIODS, (onset.last, earlier), longest_leap)
        self._periods.leaps = onset.leaps
        self._clock = LeapWatch() if longest_leap else None
        """Of a clock that may leap, None of another."""
        self._window = WindowOrder()
        self._published = PublishedCounts()
        self._others = tuple(role for role in participants if role != RECORDER)
        self._arrived = {name: onset.before.get(name, 0) for name in self._channel_of}
        self._transforms = TransformSource()
        self._has_drive = "drive" in participants
        self._truth: bytes | None = None
        self._truth_channel, self._odometry_channel = self._channel_of[TRUTH], self._channel_of[ODOMETRY]

    def take(self, row: Topic, stamp: int, message: bytes) -> None:
        """Take one message of a row; what cannot be read and should be is refused, and kept."""
        self.last_arrival = time.monotonic()
        rank = 0
        if row.publisher == "all":
            try:
                found = self._hear(row, stamp, message)
            except RefusedMessageError as refusal:
                self._refuse(row.name, str(refusal))
                found = len(ROLES)
            if found is None:
                return
            rank = found
        name = row.name
        self._arrived[name] += 1
        channel = self._channel_of[name]
        if not self.lockstep:
            self._window.offer(channel, stamp, rank, message)
        elif row.publisher == "all":
            self._periods.offer_heartbeat(channel, stamp, rank, message)
        elif row.is_event:
            self._periods.offer_goal(channel, stamp, message)
        else:
            self._periods.offer(channel, stamp, message)
            if name == TICK:
                self._announce(row, stamp, message)
            elif name == CLOCK and self._clock is not None:
                leap = self._clock.hear(stamp // CONTROL_PERIOD_NS)
                if leap is not None:
                    self._periods.leap(*leap)

    def advance(self, now: int) -> None:
        """In real time: it is `now` [ns], by the clock of the plant."""
        self.last_stamp = self._window.newest = now

    def collect(self) -> int:
        """Step to the next period of lock-step if it is complete. Returns its stamp [ns], 0 if it is not."""
        return self._periods.collected * CONTROL_PERIOD_NS if self._periods.collect() else 0

    def write_period(self) -> int:
        """Write the next period of lock-step if it is ready. Returns its number, 0 if it is not."""
        released = self._periods.release()
        if released is None:
            return 0
        self._write(released[1])
        return released[0]

    def write_window(self) -> None:
        """Write what has waited long enough in real time."""
        self._write(self._window.release())

    def missing(self) -> list[Topic]:
        """Rows that the period in progress waits for."""
        return self._periods.missing()

    def lacks(self, row: Topic, stamp: int) -> bool:
        """Whether lock-step waits for a message of a row."""
        return self._periods.lacks(self._channel_of[row.name], stamp)

    def has_all(self) -> bool:
        """Whether all have said farewell, and everything that they say they have sent is here."""
        published = self._published.totals()
        here = all(self._arrived.get(name, count) >= count for name, count in published.items())
        return here and self._have_ended

    def finish(self, run: Mapping[str, str]) -> Completeness:
        """Write what is left and close the bag with its account.

        Args:
            run: metadata record that describes the run.
        """
        if self.lockstep:
            self.last_stamp = self._last_period * CONTROL_PERIOD_NS
        self._write(self._periods.release_all() if self.lockstep else self._window.release_all())
        completeness = account(
            self._rows,
            self.writer.recorded(),
            self._published.totals(),
            self.last_stamp if self.lockstep else None,
            [self._rows[self._channel_of[row.name]] for row in self._awaited],
            self._onset.before,
            self._periods.leaps,
        )
        record = {**run, "last_stamp_ns": str(self.last_stamp)}
        self.writer.close({RUN_RECORD: record, RECORD: completeness.as_record()})
        return completeness

    @property
    def _have_ended(self) -> bool:
        """Whether all others have said farewell."""
        return self._published.has_ended(self._others)

    @property
    def _last_period(self) -> int:
        """Of lock-step: the one that has begun last; where all have said farewell the last that any has acted on, as
        they may have been told to end before the next.
        """
        periods = self._periods
        return periods.last_answered if self._have_ended else periods.last_begun

    def _hear(self, row: Topic, stamp: int, message: bytes) -> int | None:
        """Read a heartbeat. Returns its sender's rank, or None where it is no part of the record.

        The record has the heartbeats of the run. Those from before it, a word of waiting and the farewell come when
        the wall clock has them come, and would make two records of the same run differ.
        """
        array = decode(row, message)
        with refusing(row.name, "heartbeats that can be read"):
            heartbeats = read_heartbeats(array)
        if stamp <= 0 and heartbeats:
            return None
        for heartbeat in heartbeats:
            if heartbeat.role in ROLES:
                self._published.hear(heartbeat)
        if heartbeats and all(heartbeat.state in OUTSIDE_THE_RECORD for heartbeat in heartbeats):
            return None
        role = heartbeats[0].role if heartbeats else ""
        return ROLES.index(role) if role in ROLES else len(ROLES)

    def _announce(self, row: Topic, stamp: int, message: bytes) -> None:
        """The operator's tick says how many goals it has sent."""
        try:
            counts, _ = parse_tick(decode(row, message).frame)
        except RefusedMessageError as refusal:
            self._refuse(row.name, str(refusal))
            return
        known = {self._channel_of[name]: count for name, count in counts.items() if name in self._channel_of}
        self._periods.announce(stamp, known)

    def _write(self, entries: list[Entry]) -> None:
        """Write messages in order; /tf follows the odometry, or the truth where nothing drives."""
        write = self.writer.write
        for log_time, channel, _, _, stamp, data in entries:
            write(channel, log_time, stamp if stamp > 0 else log_time, data)
            if channel == self._truth_channel:
                self._truth = data
                if not self._has_drive:
                    self._write_transform(log_time, data, None)
            elif channel == self._odometry_channel and self._has_drive:
                self._write_transform(log_time, self._truth, data)

    def _write_transform(self, stamp: int, truth: bytes | None, odometry: bytes | None) -> None:
        try:
            message = self._transforms.message(stamp, truth, odometry)
        except struct.error as error:
            topic = TRUTH if odometry is None else ODOMETRY
            self._refuse(topic, str(RefusedMessageError(topic, "pose", f"unreadable ({error})", "a pose, for /tf")))
            return
        if message is not None:
            self.writer.write(len(self._rows), stamp, stamp, message)
