"""Whether the faults of a run showed as its scenario expects: detected in so many seconds, missed, or a false alarm.

A fault is detected when the text that is expected stands in its field of a status, at the stamp of that status, within
the time that is allowed from the stamp of the fault on. It is missed if that comes later or not at all, and not judged
where the record ends before that time is over. Where the text stands there before its fault has come it is a false
alarm, whatever follows. A fault that had come before the bag began, at a checkpoint, is judged by the bag where it
begins to show there in time; else by that of the run before alone.

What is asked for on /faults has not come where whose it is has refused it: its heartbeats count what they refuse, and
name the faults that are there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.extent import sim_time
from sojourn_bags.onset import HEARTBEATS, faults_before
from sojourn_bags.reading import Bag
from sojourn_contract.fault_messages import GONE
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import is_count
from sojourn_machine.fault_choice import ExpectedDetection, FaultChoice

DETECTED, MISSED, FALSE_ALARM, ABSENT, UNJUDGED = "detected", "missed", "false alarm", "did not come", "not judged"
EARLIER, REFUSED = "came before this record", "refused"
NOT_ASKED = (UNJUDGED, EARLIER, REFUSED)
"""Of these nobody can say whether the fault was detected."""
GOOD = (DETECTED, *NOT_ASKED)
BEATS = 3
"""Heartbeats after a fault by which whose it is has said what became of it: where a run is fast, messages come late."""
REFUSALS = f"refused {FAULTS_TOPIC}"
FAULT_TEXTS = ("name", "faults", REFUSALS, "last refusal")
"""What is read of a heartbeat."""
ROUNDING_S = 1e-6
"""Of stamps as numbers [s]."""


class Coming(NamedTuple):
    """Of a fault, as the bag tells it."""

    kind: str
    """Empty where the bag does not tell."""
    begin: float | None
    """[s]; None where it has not come."""
    end: float | None = None
    """[s]; None where it has not gone, or has come again."""
    is_earlier: bool = False
    """Whether it had come before the bag began."""
    refusal: str = ""
    """Why it has not come; empty where nobody refused it."""


class FaultsTold(NamedTuple):
    """What a heartbeat says of faults."""

    time: float
    """[s]"""
    there: Sequence[str]
    refused: int
    """How many so far."""
    reason: str
    """Of the last refusal."""


NEVER = Coming("", None)


@dataclass(frozen=True)
class FaultResult:
    """What became of a fault.

    Args:
        fault: its name. kind: what it is, "" where the bag does not say. begin_s: when it came first, None if it did
            not [s]. end_s: when it went for good, None if it did not [s]. outcome: one of the words above. after_s:
            from the fault to the first time that it showed, or of a false alarm to the fault; None where it did not
            show [s]. expected: what should show it, in words; "" where nobody says. reason: of the outcome, or "".
    """

    fault: str
    kind: str
    begin_s: float | None
    end_s: float | None
    outcome: str
    after_s: float | None
    expected: str
    reason: str = ""

    @property
    def good(self) -> bool:
        """Whether it showed as it should, or nobody said how."""
        return self.outcome in GOOD

    @property
    def words(self) -> str:
        """For a terminal."""
        if self.outcome == DETECTED:
            return f"detected in {self.after_s:.1f} s"
        if self.outcome == MISSED:
            late = "" if self.after_s is None else f", it showed after {self.after_s:.1f} s"
            return f"missed: {self.expected}{late}"
        if self.outcome == FALSE_ALARM:
            when = "though it never came" if self.after_s is None else f"{self.after_s:.1f} s before it came"
            return f"false alarm: {self.expected}, {when}"
        return f"{self.outcome}: {self.reason}" if self.reason else self.outcome

    def as_data(self) -> dict[str, object]:
        """For the summary."""
        return {**asdict(self), "good": self.good, "words": self.words}


def judge_faults(bag: Bag, schedule: Sequence[FaultChoice]) -> list[FaultResult]:
    """Results of the faults of a schedule in its order, then of those that came besides.

    Args:
        bag: of the run. schedule: of its scenario.
    """
    came = _came(bag)
    planned = {fault.called: fault for fault in schedule}
    return [
        _judged(bag, name, came.get(name, NEVER), planned.get(name))
        for name in (*planned, *(name for name in came if name not in planned))
    ]


def sentence(results: Sequence[FaultResult]) -> str:
    """All of them in a sentence for the verdict; "" where nothing was to be judged."""
    judged = [result for result in results if result.outcome not in NOT_ASKED]
    if not judged:
        return ""
    found = sum(result.outcome == DETECTED for result in judged)
    others = "; ".join(f"{result.fault}: {result.words}" for result in judged if result.outcome != DETECTED)
    return f"{found} of {len(judged)} faults were detected{': ' if others else '.'}{others}{'.' if others else ''}"


def _came(bag: Bag) -> dict[str, Coming]:
    """The faults that have come or were refused, by their names."""
    before = faults_before(bag.records.get(RUN_RECORD, {}))
    found = {name: Coming("", *span, is_earlier=True) for name, span in before.items()}
    if FAULTS_TOPIC not in bag:
        return found
    beats = _beats(bag)
    for time, status in zip(bag[FAULTS_TOPIC].times.tolist(), bag[FAULTS_TOPIC].statuses(), strict=True):
        name = status.get("name", "")
        known = found.get(name, NEVER)
        if status.get("state") == GONE:
            if known.begin is not None:
                found[name] = known._replace(end=time)
        elif known.begin is None:
            why = _refusal(beats, name, time)
            found[name] = Coming(status.get("kind", ""), None if why else time, refusal=why)
        elif known.end is not None and not _refusal(beats, name, time):
            found[name] = known._replace(end=None)
    return found


def _beats(bag: Bag) -> Mapping[str, Sequence[FaultsTold]]:
    """What the heartbeats say of faults, by role."""
    found: dict[str, list[FaultsTold]] = {}
    if HEARTBEATS not in bag:
        return found
    for time, status in zip(bag[HEARTBEATS].times.tolist(), bag[HEARTBEATS].statuses(), strict=True):
        there, refused = status.get("faults", "").split(", "), status.get(REFUSALS, "0")
        told = FaultsTold(time, there, int(refused) if is_count(refused) else 0, status.get("last refusal", ""))
        found.setdefault(status.get("name", ""), []).append(told)
    return found


def _refusal(beats: Mapping[str, Sequence[FaultsTold]], name: str, time: float) -> str:
    """Why a fault that was to come at a time [s] was refused; empty where nobody says so, or it is there after all."""
    why = ""
    for told in beats.values():
        before = [beat for beat in told if beat.time <= time]
        after = [beat for beat in told if beat.time > time][:BEATS]
        if any(name in beat.there for beat in after):
            return ""
        more = [beat for beat in after if before and beat.refused > before[-1].refused]
        if more:
            why = more[0].reason or "no reason is given"
    return why


def _judged(bag: Bag, name: str, came: Coming, planned: FaultChoice | None) -> FaultResult:
    begin, end = came.begin, came.end
    kind, expect = (came.kind, None) if planned is None else (planned.kind, planned.expect)
    if planned is None and came.refusal:
        return FaultResult(name, kind, begin, end, REFUSED, None, "", came.refusal)
    if expect is None:
        return FaultResult(name, kind, begin, end, UNJUDGED if begin is not None else ABSENT, None, "")
    words = f"{expect.says!r} in {expect.field} of {expect.topic} within {expect.within:g} s"
    shows = _shows(bag, expect)
    if begin is not None and came.is_earlier:
        after = shows[0] - begin if shows and shows[0] > bag[expect.topic].times[0] else None
        in_time = after is not None and after <= expect.within
        return FaultResult(name, kind, begin, end, *((DETECTED, after) if in_time else (EARLIER, None)), words)
    if shows and (begin is None or shows[0] < begin):
        early = None if begin is None else begin - shows[0]
        return FaultResult(name, kind, begin, end, FALSE_ALARM, early, words)
    if begin is None:
        return FaultResult(name, kind, begin, end, ABSENT, None, words)
    after = shows[0] - begin if shows else None
    if after is not None and after <= expect.within:
        return FaultResult(name, kind, begin, end, DETECTED, after, words)
    held = sim_time(bag) - begin
    if held < expect.within - ROUNDING_S:
        why = f"the record ended {max(held, 0.0):.1f} s after it came"
        return FaultResult(name, kind, begin, end, UNJUDGED, None, words, why)
    return FaultResult(name, kind, begin, end, MISSED, after, words)


def _shows(bag: Bag, expect: ExpectedDetection) -> list[float]:
    """When the text stands where it is expected [s]."""
    if expect.topic not in bag:
        return []
    messages = bag[expect.topic]
    pairs: Any = zip(messages.times.tolist(), messages.statuses(), strict=True)
    return [time for time, status in pairs if expect.says in status.get(expect.field, "")]
