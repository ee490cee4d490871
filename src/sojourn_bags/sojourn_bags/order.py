"""Puts received messages in the order of the file: by stamp, then by row of the topic table, then by sender.

No ROS in here. In lock-step a period is released when everything that is due in it has come, so that the file
is the same from run to run. In real time messages wait a short while of simulation time and are then
released.

What comes late, stamped off the grid or twice is kept as well: the recorder records, others judge. It is
filed under the period in which it is written.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from math import lcm
from typing import TypeAlias

from sojourn_contract.barrier import is_due
from sojourn_contract.leaps import NO_LEAPS
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic

Entry: TypeAlias = tuple[int, int, int, int, int, bytes]
"""log time [ns], channel, rank of the sender, order of arrival, header stamp [ns], CDR. Sorted as a tuple."""

MAX_AHEAD_PERIODS = 512
"""A message stamped further ahead than this is filed under the period in which it came."""
HOLD_PERIODS = 10
"""Complete periods that wait at most for a heartbeat that is due in an earlier one."""
WINDOW_NS = 10 * CONTROL_PERIOD_NS
"""Simulation time that a message waits for earlier ones, in real time."""
MOST_WAITING = 5000
"""Messages that wait at most, in real time: many times those of a window. Where a flood keeps the clock from the
recorder more come, and the oldest are written.
"""
TICK = "/operator/tick"


class PeriodOrder:
    """Lock-step: collects periods and releases them whole.

    Args:
        awaited: rows that are waited for, with their channel.
        heartbeat_roles: ranks of the senders of heartbeats; a period with heartbeats waits for them, but not
            for ever.
        heartbeat_periods: periods between two heartbeats.
        begun: the period before the first, and how many goals of each channel belong to it and to those before.
        longest_leap: control periods by which the clock may leap.
    """

    def __init__(
        self,
        awaited: Sequence[tuple[int, Topic]],
        heartbeat_roles: frozenset[int],
        heartbeat_periods: int,
        begun: tuple[int, Mapping[int, int]] = (0, {}),
        longest_leap: int = 0,
    ) -> None:
        self.collected = begun[0]
        """Last period of which everything due has come."""
        self.released = begun[0]
        """Last period that has been released."""
        self.leaps = NO_LEAPS
        """Of the clock, as far as they are known."""
        self._ahead = MAX_AHEAD_PERIODS + 2 * longest_leap  # the plant is one ahead, and says where the next one lands
        self._ready = deque[int]()
        """Periods that are collected and not released."""
        self._awaited = tuple((channel, row) for channel, row in awaited if row.delivery is None)
        self._delivered = {channel: row for channel, row in awaited if row.delivery is not None}
        self._here: set[tuple[int, int]] = set()
        """Channel and stamp of the measurement of messages of rows with a delivery, until the period in which they
        leave is collected."""
        self._repeated = {
            channel: max(each for each in delivery.samples(0, begun[0]) if 0 < delivery.comes(each) <= begun[0])
            for channel, row in self._delivered.items()
            if (delivery := row.delivery) is not None and 0 < delivery.comes(delivery.stands_at) <= begun[0]
        }
        """By channel of senders whose clock has stopped: period of the last measurement that came."""
        self._bits = {channel: 1 << number for number, (channel, _) in enumerate(self._awaited)}
        self._truth = sum(self._bits[channel] for channel, row in self._awaited if row.publisher == "plant")
        self._cycle = lcm(*(row.every for _, row in self._awaited))
        self._masks: dict[int, int] = {}
        self._arrived: dict[int, int] = {}
        self._entries: dict[int, list[Entry]] = {}
        self._ticks: dict[int, dict[int, int]] = {}
        self._goals: dict[int, int] = dict(begun[1])
        self._heartbeat_roles = heartbeat_roles
        self._heartbeat_periods = heartbeat_periods
        self._heard: dict[int, set[int]] = {}
        self._arrivals = 0

    def offer(self, channel: int, stamp: int, data: bytes) -> None:
        """Take a message of an awaited row."""
        delivered = self._delivered.get(channel)
        if delivered is not None:
            measured = self._measured(channel, delivered, stamp)
            self._here.add((channel, measured))
            period = self._period_of(delivered.comes_at(measured))
            self._keep(period, channel, 0, stamp, data, period * CONTROL_PERIOD_NS)
            return
        period = self._period_of(stamp)
        if stamp == period * CONTROL_PERIOD_NS and period > self.collected:
            self._arrived[period] = self._arrived.get(period, 0) | self._bits[channel]
        self._keep(period, channel, 0, stamp, data)

    def offer_goal(self, channel: int, stamp: int, data: bytes) -> None:
        """Take a goal. Stamp zero means now."""
        self._goals[channel] = self._goals.get(channel, 0) + 1
        self._keep(self._period_of(stamp), channel, 0, stamp, data)

    def offer_heartbeat(self, channel: int, stamp: int, rank: int, data: bytes) -> None:
        """Take a message of /diagnostics from the sender with this rank."""
        period = self._period_of(stamp)
        self._heard.setdefault(period, set()).add(rank)
        self._keep(period, channel, rank, stamp, data)

    def announce(self, stamp: int, counts: dict[int, int]) -> None:
        """How many goals have been sent on each channel by this stamp: the period waits for them."""
        if stamp <= (self.collected + self._ahead) * CONTROL_PERIOD_NS:
            self._ticks[stamp // CONTROL_PERIOD_NS] = counts

    def leap(self, begin: int, end: int) -> None:
        """The clock tells no period between these two."""
        self.leaps = self.leaps.with_leap(begin, end)

    def collect(self) -> bool:
        """Step to the next period if everything that is due in it has come."""
        period = self.leaps.after(self.collected)
        due = self._due(period)
        leaving = self._leaving(period)
        if self._arrived.get(period, 0) & due != due or not self._here.issuperset(leaving):
            return False
        for channel, count in self._ticks.get(period, {}).items():
            if self._goals.get(channel, 0) < count:
                return False
        self._arrived.pop(period, None)
        self._ticks.pop(period, None)
        self._here.difference_update(leaving)
        self.collected = period
        self._ready.append(period)
        return True

    def release(self) -> tuple[int, list[Entry]] | None:
        """The next period to write, with its messages in order, or None."""
        if not self._ready:
            return None
        period = self._ready[0]
        if period % self._heartbeat_periods == 0 and len(self._ready) <= HOLD_PERIODS:
            heard = self._heard.get(period, set())
            if not self._heartbeat_roles <= heard:
                return None
        self.released = self._ready.popleft()
        self._heard.pop(period, None)
        entries = self._entries.pop(period, [])
        entries.sort()
        return period, entries

    def release_all(self) -> list[Entry]:
        """Everything that is left, complete or not, in order."""
        rest = [entry for period in sorted(self._entries) for entry in sorted(self._entries[period])]
        self._entries.clear()
        return rest

    def missing(self) -> list[Topic]:
        """Rows that the period in progress waits for."""
        period = self.leaps.after(self.collected)
        lacking = {channel for channel, _ in self._to_come(period)}
        rows = [row for channel, row in self._awaited if self.lacks(channel, period * CONTROL_PERIOD_NS)]
        return rows + [row for channel, row in self._delivered.items() if channel in lacking]

    def lacks(self, channel: int, stamp: int) -> bool:
        """Whether a period that is not collected waits for a message of an awaited row."""
        if channel in self._delivered:
            return (channel, stamp) in self._to_come(self.leaps.after(self.collected))
        period, rest = divmod(stamp, CONTROL_PERIOD_NS)
        if rest or not self.collected < period <= self.collected + self._ahead:
            return False
        return bool(self._due(period) & self._bits[channel]) and not self._arrived.get(period, 0) & self._bits[channel]

    @property
    def last_begun(self) -> int:
        """Last period of which something has come on two topics: one message with a stamp of its own begins none."""
        return max((period for period, bits in self._arrived.items() if bits & (bits - 1)), default=self.collected)

    @property
    def last_answered(self) -> int:
        """Last period that a role has acted on: the plant tells the truth of a period before."""
        return max((period for period, bits in self._arrived.items() if bits & ~self._truth), default=self.collected)

    def _measured(self, channel: int, row: Topic, stamp: int) -> int:
        """When that was measured [ns] whose message has a stamp: later, where the sender's clock has stopped."""
        delivery = row.delivery
        if delivery is None or stamp != delivery.stands_at * CONTROL_PERIOD_NS:
            return stamp
        last = self._repeated.get(channel)
        self._repeated[channel] = delivery.stands_at if last is None else delivery.following(last)
        return self._repeated[channel] * CONTROL_PERIOD_NS

    def _leaving(self, period: int) -> list[tuple[int, int]]:
        """Channel and stamp of messages that leave in a period, of rows with a delivery."""
        return [
            (channel, each * CONTROL_PERIOD_NS)
            for channel, row in self._delivered.items()
            if row.delivery is not None
            for each in row.delivery.left_at(period)
        ]

    def _to_come(self, period: int) -> set[tuple[int, int]]:
        """Of those, the ones that are not here."""
        return set(self._leaving(period)) - self._here

    def _due(self, period: int) -> int:
        """Bits of the rows that are due. The pattern repeats, because no row lags for the recorder."""
        key = period % self._cycle
        mask = self._masks.get(key)
        if mask is None:
            mask = sum(self._bits[channel] for channel, row in self._awaited if is_due(row, period))
            self._masks[key] = mask
        return mask

    def _period_of(self, stamp: int) -> int:
        """Period under which a message is filed: that of its stamp; where a clock that is not ours has stamped it, the
        one in which it came.
        """
        period = -(-stamp // CONTROL_PERIOD_NS)
        return period if period <= self.collected + self._ahead else self.leaps.after(self.collected)

    def _keep(self, period: int, channel: int, rank: int, stamp: int, data: bytes, heard: int = 0) -> None:
        """heard: when it is there [ns], 0 for with its stamp."""
        log_time = heard or stamp
        if period <= self.released:
            period = self.leaps.after(self.released)
            log_time = period * CONTROL_PERIOD_NS
        elif log_time > period * CONTROL_PERIOD_NS:  # a goal from far ahead
            log_time = period * CONTROL_PERIOD_NS
        self._arrivals += 1
        entry = (log_time, channel, rank, self._arrivals, stamp, data)
        kept = self._entries.get(period)
        if kept is None:
            self._entries[period] = [entry]
        else:
            kept.append(entry)


class WindowOrder:
    """Real time: holds messages for WINDOW_NS of simulation time, and never goes back in time."""

    def __init__(self) -> None:
        self.newest = 0
        self._entries: list[Entry] = []
        self._arrivals = 0
        self._written = 0

    def offer(self, channel: int, stamp: int, rank: int, data: bytes) -> None:
        """Take a message."""
        self._arrivals += 1
        if stamp <= 0 or (self.newest and stamp > self.newest + MAX_AHEAD_PERIODS * CONTROL_PERIOD_NS):
            log_time = self.newest  # a goal for now, or a clock that is not ours
        else:
            log_time = stamp
        self._entries.append((max(log_time, self._written), channel, rank, self._arrivals, stamp, data))

    def release(self) -> list[Entry]:
        """Messages older than the window, in order; the older half where too many wait."""
        if len(self._entries) > MOST_WAITING:
            self._entries.sort()
            return self._take(self._entries[MOST_WAITING // 2][0])
        return self._take(self.newest - WINDOW_NS)

    def release_all(self) -> list[Entry]:
        """Everything that is left, in order."""
        return self._take(None)

    def _take(self, until: int | None) -> list[Entry]:
        self._entries.sort()
        count = len(self._entries)
        if until is not None:
            count = next((number for number, entry in enumerate(self._entries) if entry[0] > until), count)
        taken = self._entries[:count]
        del self._entries[:count]
        if taken:
            self._written = taken[-1][0]
        return taken
