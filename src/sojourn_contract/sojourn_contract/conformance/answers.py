"""Lock-step: exactly one message of every row at each stamp at which it is due.

A message that is missing is held against its sender only if the sender had its inputs of that stamp: an
answer cannot come where nothing was asked. Only for the plant, which paces everybody, nothing excuses a gap.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from sojourn_contract.barrier import is_due, stamp_due
from sojourn_contract.conformance.findings import Finding
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS, seconds
from sojourn_contract.topic_types import Topic


def missing_answers(
    rows: Sequence[Topic],
    stamps: Mapping[str, Collection[int]],
    awaited: Mapping[str, Sequence[Topic]],
    begin: int,
    end: int,
    leaps: Leaps = NO_LEAPS,
) -> Iterator[tuple[Topic, int, Finding]]:
    """What is missing with begin < stamp <= end [ns]: row, stamp and finding, in the order of time.

    Args:
        rows: periodic rows to judge. awaited: what each role of the run waits for.
        stamps: those that have come, by topic; an input of a topic that is not in it excuses nothing.
        leaps: of the clock.
    """
    seen = {name: frozenset(found) for name, found in stamps.items()}
    inputs = {role: _inputs(role, found, seen) for role, found in awaited.items()}
    gaps = []
    for place, row in enumerate(rows):
        for stamp in _due(row, begin, end, leaps):
            if stamp not in seen[row.name] and _was_asked(stamp, inputs[row.publisher], seen, leaps):
                gaps.append((stamp, place))
    for stamp, place in sorted(gaps):
        row = rows[place]
        allowed = f"one message each {seconds(row.every * CONTROL_PERIOD_NS):g} s{_why(inputs[row.publisher])}"
        yield row, stamp, Finding("header.stamp", "missing", allowed)


def _due(row: Topic, begin: int, end: int, leaps: Leaps) -> Iterable[int]:
    """Stamps [ns] of the messages of a row with begin < stamp that are there by `end`."""
    if row.delivery is not None:
        departures = row.delivery.departures(end // CONTROL_PERIOD_NS)
        return [each * CONTROL_PERIOD_NS for each in departures if each * CONTROL_PERIOD_NS > begin]
    return leaps.stamps(row.every, begin, leaps.lagging(end, row.lag))


def _inputs(role: str, awaited: Sequence[Topic], seen: Mapping[str, Collection[int]]) -> list[Topic]:
    """What a role waits for in each period; nothing for the plant, which begins each of them."""
    if role == "plant":
        return []
    return [row for row in awaited if row.publisher != "all" and row.name in seen]


def _was_asked(stamp: int, inputs: Sequence[Topic], seen: Mapping[str, Collection[int]], leaps: Leaps) -> bool:
    """Whether all inputs that are due at this stamp were there."""
    period = stamp // CONTROL_PERIOD_NS
    return all(stamp_due(row, period, leaps) in seen[row.name] for row in inputs if is_due(row, period))


def _why(inputs: Sequence[Topic]) -> str:
    if not inputs:
        return ""
    fastest = min(row.every for row in inputs)
    return ", since its inputs were there: " + ", ".join(row.name for row in inputs if row.every == fastest)
