"""Readings that are told later than they were measured: those of a sensor with a `timing` of its own.

When they leave the run's table says (`sojourn_contract.delivery`); here they wait. What waits is a value: it is part
of the role's state.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sojourn_contract.topic_types import Topic


@dataclass(frozen=True, slots=True)
class LateReading:
    """A reading that is not told yet."""

    leaves: int
    """Control period in which it is told."""
    measured: int
    """Control period whose stamp it bears: that in which it was measured, of a sensor whose clock runs."""
    topics: tuple[str, ...]
    """On which it is told."""
    reading: Any


class Timing:
    """Of one sensor: when it measures, and when it tells what.

    Args:
        rows: on which it speaks, all with a delivery. every: how often its kind measures by itself.
    """

    def __init__(self, rows: Sequence[Topic], every: int) -> None:
        self._rows = [(row.name, row.delivery) for row in rows if row.delivery is not None]
        self._always = every == 1

    def measures(self, period: int) -> bool:
        """Whether the sensor measures in a control period; a kind that does in every one goes on with that."""
        return self._always or any(delivery.measures(period) for _, delivery in self._rows)

    def with_reading(self, waiting: Sequence[LateReading], period: int, reading: Any) -> list[LateReading]:
        """What waits with that which was measured in a control period, in the order of the measurements."""
        topics: dict[tuple[int, int], list[str]] = {}
        for name, delivery in self._rows:
            leaves = delivery.comes(period)
            if leaves:
                topics.setdefault((leaves, delivery.stamped(period)), []).append(name)
        return [*waiting, *(LateReading(*when, tuple(names), reading) for when, names in topics.items())]

    def lost(self, begun: int, period: int, reading: Any) -> list[LateReading]:
        """What leaves in a control period and was measured before another process began, in period `begun`: nobody
        knows it any more. In lock-step others wait for it, so a reading of this process stands for it, under its stamp.
        """
        return [
            LateReading(period, delivery.stamped(measured), (name,), reading)
            for name, delivery in self._rows
            if period - begun <= delivery.longest
            for measured in delivery.left_at(period)
            if measured < begun
        ]


def timing_of(rows: Sequence[Topic], every: int) -> Timing | None:
    """The timing of a sensor that speaks on these rows; None where all is said when it is measured."""
    return Timing(rows, every) if any(row.delivery is not None for row in rows) else None
