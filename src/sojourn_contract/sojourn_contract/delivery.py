"""When the messages of a row are there that do not come with their stamp: late, unevenly late, now and then not at all.

A row with a `Delivery` is measured at stamps of its own and heard later. Who hears it acts on the newest message that
has left by its period, as one does who reads the latest of a topic: until there is a newer one, and no longer than it
may age. Which one that is follows from the row alone, so that in lock-step everybody waits for the same message and
nobody for one that is lost; a run is the same in every layout.

Chance is a function of the sample's number (`sojourn_machine.chance`), and so no state that anybody keeps, and no
number of another sensor.

Messages whose sender's clock has stopped (`Loss.frozen`) are lost to everybody who goes by stamps, though they come:
they bear the stamp of the last sample before. Who records them knows by their number when they came.

A sample of control period p leaves in the first period at or after p T + latency + j, j even between zero and the
jitter, but not before an earlier sample: messages of a topic do not overtake each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_machine.chance import chance

LONGEST_SILENCE = 10_000
"""Messages of which one at least is not lost, or all are [-]."""
_JITTER = 0
"""Salt of the jitter; those of the losses follow."""


@dataclass(frozen=True)
class Loss:
    """Messages that are lost, each for itself.

    Args:
        begin: stamp from which on [ns]. probability: of each message.
        frozen: they come, with the stamp of the last one before.
    """

    begin: int
    probability: float
    frozen: bool = False


@dataclass(frozen=True)
class Delivery:
    """When messages of a row are measured and heard.

    Args:
        every: control periods from one measurement to the next. phase: periods by which it is after the full one.
        pace: its listeners look each so many control periods.
        latency: shortest time from stamp to message [ns]. jitter: most that is added [ns].
        losses: what does not arrive. stream: of its random numbers.
    """

    every: int
    phase: int = 0
    pace: int = 1
    latency: int = 0
    jitter: int = 0
    losses: tuple[Loss, ...] = ()
    stream: int = 0

    @property
    def longest(self) -> int:
        """Control periods from a measurement to its message at most."""
        return _periods(self.latency + self.jitter)

    def measures(self, period: int) -> bool:
        """Whether it measures in a control period (1, 2, ...)."""
        return period > 0 and period % self.every == self.phase

    def is_lost(self, period: int) -> bool:
        """Whether no message with the stamp of what is measured in a period arrives."""
        return self._is_frozen(period) or self.is_silent(period)

    def is_silent(self, period: int) -> bool:
        """Whether no message at all arrives of what is measured in a period."""
        return any(
            not loss.frozen
            and period * CONTROL_PERIOD_NS >= loss.begin
            and chance(self.stream, salt, period) < loss.probability
            for salt, loss in enumerate(self.losses, _JITTER + 1)
        )

    def leaves(self, period: int) -> int:
        """Control period in which the message leaves of what is measured in a period; 0 where there is none with that
        stamp.
        """
        return 0 if self._is_frozen(period) else self.comes(period)

    def comes(self, period: int) -> int:
        """Likewise, with whatever stamp."""
        return _leaves(self, period) if self.measures(period) and not self.is_silent(period) else 0

    @property
    def stands_at(self) -> int:
        """Control period whose stamp is borne by all messages of a clock that stops, its own first; 0 of one that
        runs.
        """
        return _stands_at(self) if any(loss.frozen for loss in self.losses) else 0

    def stamped(self, period: int) -> int:
        """Control period whose stamp the message of what is measured in a period bears."""
        return self.stands_at if self._is_frozen(period) else period

    def following(self, period: int) -> int:
        """Period of the first measurement after a period of which a message comes; 0 where none does for very long."""
        later = self.samples(period, period + LONGEST_SILENCE * self.every)
        return next((each for each in later if not self.is_silent(each)), 0)

    def _is_frozen(self, period: int) -> bool:
        return 0 < self.stands_at < period

    def left_at(self, period: int) -> list[int]:
        """Periods of the measurements whose messages leave in a control period, with whatever stamp, in their order."""
        return [each for each in self.samples(period - self.longest - 1, period) if self.comes(each) == period]

    def newest(self, period: int, age: int) -> int:
        """Period of the newest measurement whose message has left by a control period; 0 where none has, or none that
        is `age` control periods old at most.
        """
        return _newest(self, period, age)

    def samples(self, begin: int, end: int) -> range:
        """Periods in which it measures, begin < period <= end, lost or not."""
        begin = max(begin, 0)
        first = begin + 1 + (self.phase - begin - 1) % self.every
        return range(first, end + 1, self.every)

    def departures(self, end: int) -> Iterator[int]:
        """Periods of all measurements whose messages have left by a control period, in their order."""
        return (each for each in self.samples(0, end) if 0 < self.leaves(each) <= end)

    def departure(self, period: int) -> int:
        """Control period in which its own latency and jitter would have the measurement of a period leave."""
        jitter = int(self.jitter * chance(self.stream, _JITTER, period)) if self.jitter else 0
        return period + _periods(self.latency + jitter)


def _periods(time: int) -> int:
    """Whole control periods that a time [ns] takes at least."""
    return -(-time // CONTROL_PERIOD_NS)


@lru_cache(maxsize=1 << 14)
def _leaves(delivery: Delivery, period: int) -> int:
    """No earlier than those that were measured before."""
    earlier = delivery.samples(period - _periods(delivery.jitter) - 1, period - 1)
    return max(
        [delivery.departure(period)] + [delivery.departure(each) for each in earlier if not delivery.is_silent(each)]
    )


@lru_cache(maxsize=1 << 14)
def _newest(delivery: Delivery, period: int, age: int) -> int:
    last = period - _periods(delivery.latency)
    for each in reversed(delivery.samples(period - age - 1, last)):
        if 0 < delivery.leaves(each) <= period:
            return each
    return 0


@lru_cache(maxsize=1 << 8)
def _stands_at(delivery: Delivery) -> int:
    """The last before the clock stops of which a message comes; where there is none the first that has one."""
    begin = min(loss.begin for loss in delivery.losses if loss.frozen)
    before = delivery.samples(0, -(-begin // CONTROL_PERIOD_NS) - 1)
    return next((each for each in reversed(before) if not delivery.is_silent(each)), 0) or delivery.following(0)
