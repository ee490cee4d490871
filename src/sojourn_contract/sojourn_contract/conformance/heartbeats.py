"""Heartbeats: one a simulated second from every role, whose counters never fall and match what has come."""

from bisect import bisect_right
from collections.abc import Collection, Iterator, Mapping, Sequence

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.conformance.ros_reading import diagnostics_of
from sojourn_contract.heartbeat import ENDED, READY, RUNNING, STALLED, WAITING_TO_MATCH, Heartbeat, read_heartbeats
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS, seconds
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, topic

STATES = (WAITING_TO_MATCH, READY, RUNNING, STALLED, ENDED)
HEARTBEATS = "/diagnostics"
STAMP = "header.stamp"
_ROW = topic(HEARTBEATS)
BEAT_NS = _ROW.every * CONTROL_PERIOD_NS


class HeartbeatRule:
    """What a heartbeat says of its sender."""

    name = "heartbeat"

    def judge(self, seen: Observation) -> list[Finding]:
        """A role or state that does not exist. Other people's diagnostics have no state and are passed over."""
        found = []
        for beat in read_heartbeats(diagnostics_of(seen.message)):
            if beat.role not in ROLES:
                found.append(Finding("status.name", repr(beat.role), "one of " + ", ".join(ROLES)))
            if beat.state not in STATES:
                found.append(Finding("status.values.state", repr(beat.state), "one of " + ", ".join(STATES)))
        return found


def schedule_findings(
    role: str, beats: Sequence[Heartbeat], lockstep: bool, begin: int, end: int, leaps: Leaps = NO_LEAPS
) -> Iterator[tuple[int, Finding]]:
    """Heartbeats that are missing with begin < stamp <= end [ns]: stamp and finding."""
    stamps = [beat.stamp for beat in beats if begin < beat.stamp <= end]
    field, allowed = f"{STAMP} of {role}", "one heartbeat each second of simulation"
    if lockstep:
        here = frozenset(stamps)
        for stamp in leaps.stamps(_ROW.every, begin, end):
            if stamp not in here:
                yield stamp, Finding(field, "missing", allowed)
        return
    for before, after in zip([begin, *stamps], [*stamps, end], strict=True):
        if after - before > _ROW.max_age_s * NANOSECONDS:
            gap = seconds(after - before)
            longest = f"{allowed}, {_ROW.max_age_s:g} s at most between two"
            yield before, Finding(field, f"nothing for {gap:.2f} s", longest, gap - _ROW.max_age_s)


def counter_findings(
    outputs: Sequence[Topic],
    beats: Sequence[Heartbeat],
    stamps: Mapping[str, Sequence[int]],
    from_start: bool,
    uncounted: Collection[str] = (),
    leaps: Leaps = NO_LEAPS,
) -> Iterator[tuple[int, Finding]]:
    """Counters `published /topic` against the messages that have come: stamp and finding.

    Compared from one heartbeat to the next, and from the start where the source has it.

    Args:
        outputs: topics of the role. beats: its running heartbeats, in order.
        stamps: of all messages, by topic, sorted.
        uncounted: topics whose messages may be lost on the way. leaps: of the clock.
    """
    rows = [
        row for row in outputs if row.name in stamps and row.name not in uncounted and (from_start or not row.is_event)
    ]
    first = Heartbeat("", RUNNING, "", -1, {}, {}, {})
    previous = first if from_start else None
    for beat in beats:
        if previous is not None:
            for row in rows:
                found = _counter(row, previous, beat, stamps, leaps)
                if found is not None:
                    yield beat.stamp, found
        previous = beat


def _counter(
    row: Topic, previous: Heartbeat, beat: Heartbeat, stamps: Mapping[str, Sequence[int]], leaps: Leaps
) -> Finding | None:
    field = f"status.values.published {row.name} of {beat.role}"
    before, now = previous.published.get(row.name, 0), beat.published.get(row.name, 0)
    if now < before:
        return Finding(field, now, f"{before} or more, as said before", before - now)
    if row.is_event:  # stamped ahead by their sender: only the sum can be told
        total = len(stamps[row.name])
        return Finding(field, now, f"{total} at most: there are no more", now - total) if now > total else None
    here = stamps[row.name]
    # the plant's truth of the next period is out when its heartbeat is sent
    until, begin = beat.stamp, previous.stamp
    if row.publisher == "plant":
        until, begin = (CONTROL_PERIOD_NS * leaps.after(stamp // CONTROL_PERIOD_NS) for stamp in (until, begin))
    count = bisect_right(here, until) - bisect_right(here, begin if previous.stamp >= 0 else -1)
    if row.name == HEARTBEATS:
        count = 1
    if now - before == count:
        return None
    return Finding(field, f"{now - before} more", f"{count} more, as many as have come", abs(now - before - count))
