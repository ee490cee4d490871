"""Real time: the rate of every periodic topic over windows, and the longest gap between two of its messages.

Times are stamps, so a simulation that is slower than the wall clock is not held against anybody.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, isinf

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS, seconds
from sojourn_contract.topic_types import Topic

WINDOW_S = 1.0
"""Shortest window [s]."""
LEAST_MESSAGES = 5
"""A window is so long that at least so many messages are due in it."""
RATE_TOLERANCE = 0.2
"""Share by which the number of messages in a window may differ from those due."""
GAP_PERIODS = 3
"""Longest gap in periods of a topic whose messages do not age; elsewhere it is the age at which one is lost."""


def rate_findings(
    rows: Sequence[Topic], stamps: Mapping[str, Sequence[int]], begin: int, end: int
) -> Iterator[tuple[Topic, int, Finding]]:
    """What is wrong between two stamps [ns]: row, stamp and finding.

    Args:
        rows: periodic rows to judge. stamps: those that have come, by topic.
    """
    for row in rows:
        ordered = sorted([*stamps[row.name], *_lost(row, begin, end)])
        yield from ((row, stamp, found) for stamp, found in _gaps(row, ordered, begin, end))
        yield from ((row, stamp, found) for stamp, found in _windows(row, ordered, begin, end))


def _lost(row: Topic, begin: int, end: int) -> list[int]:
    """Stamps [ns] of messages that nobody may expect: they are lost on purpose."""
    if row.delivery is None:
        return []
    periods = row.delivery.samples(begin // CONTROL_PERIOD_NS, end // CONTROL_PERIOD_NS)
    return [each * CONTROL_PERIOD_NS for each in periods if row.delivery.is_lost(each)]


def longest_gap_s(row: Topic) -> float:
    """Longest time between two messages of a row in real time [s]."""
    return GAP_PERIODS * row.every * seconds(CONTROL_PERIOD_NS) if isinf(row.max_age_s) else row.max_age_s


def _gaps(row: Topic, stamps: Sequence[int], begin: int, end: int) -> Iterator[tuple[int, Finding]]:
    longest = longest_gap_s(row)
    inside = [stamp for stamp in stamps if begin <= stamp <= end]
    for before, after in zip([begin, *inside], [*inside, end], strict=True):
        gap = seconds(after - before)
        if gap > longest:
            allowed = f"{longest:g} s at most between two messages"
            yield before, Finding("header.stamp", f"nothing for {gap:.2f} s", allowed, gap - longest)


def _windows(row: Topic, stamps: Sequence[int], begin: int, end: int) -> Iterator[tuple[int, Finding]]:
    period = row.every * CONTROL_PERIOD_NS
    width = max(int(WINDOW_S * NANOSECONDS), LEAST_MESSAGES * period)
    due = width // period
    least, most = floor((1.0 - RATE_TOLERANCE) * due), ceil((1.0 + RATE_TOLERANCE) * due)
    for start in range(begin, end - width + 1, width):
        count = bisect_right(stamps, start + width) - bisect_left(stamps, start + 1)
        if not least <= count <= most:
            rate, unit = count / seconds(width), 1.0 / seconds(width)
            allowed = f"{least * unit:g} to {most * unit:g} Hz over {seconds(width):g} s"
            off = max(least - count, count - most) * unit
            yield start, Finding("rate", f"{rate:g} Hz", allowed, off)
