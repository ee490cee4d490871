"""What a node acted on, for its heartbeat: what no stamp of a message says, so that a bag can be replayed.

In lock-step a stamp says all but when a goal took effect that somebody sent by hand. In real time nothing does: a node
acts on whatever has come, so it tells the stamp of each input at each of its periods. Texts are runs of equal numbers,
`0*49 1` for 49 zeros and a one: in most periods nothing is new.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import is_count

ACTED, HEARD, TOOK = "acted", "heard ", "took "
"""Keys: stamp of the first period, then how far each is behind the one before [ns]; how old the message of a topic was
at each [ns]; period and stamp of each goal of a topic [ns].
"""
LOST = "-"
"""For a message that there was none of, or that was refused."""
MOST_RUNS = 10_000
"""Of numbers in a text: more are refused."""


@dataclass(frozen=True)
class Took:
    """A goal that took effect: its topic, its own stamp [ns], and the stamp of the period [ns]."""

    topic: str
    stamp: int
    at: int


@dataclass(frozen=True)
class Acted:
    """A period of real time: its stamp [ns], and that of each input, None where there was none to act on."""

    at: int
    inputs: Mapping[str, int | None]


def late(goals: Iterable[tuple[str, int]], before: int, at: int) -> tuple[Took, ...]:
    """Of goals, as (topic, stamp), that take effect at a period those of which their stamp does not say so: they are
    stamped no later than the period before it.
    """
    return tuple(Took(name, stamp, at) for name, stamp in goals if stamp <= before)


def took_values(took: Iterable[Took]) -> dict[str, str]:
    """Goals, as a heartbeat tells them."""
    values: dict[str, str] = {}
    for goal in took:
        key = TOOK + goal.topic
        values[key] = f"{values[key]} {goal.at}:{goal.stamp}" if key in values else f"{goal.at}:{goal.stamp}"
    return values


def acted_values(acted: Sequence[Acted]) -> dict[str, str]:
    """Periods of real time, as a heartbeat tells them; an input that one of them has not is as one that was lost."""
    if not acted:
        return {}
    stamps, names = [each.at for each in acted], dict.fromkeys(name for each in acted for name in each.inputs)
    told = {ACTED: _runs(now - before for before, now in zip([0, *stamps], stamps, strict=False))}
    return told | {HEARD + name: _runs(_age(each, name) for each in acted) for name in names}


@dataclass
class Hearing:
    """What a node has acted on since it last told."""

    took: tuple[Took, ...] = ()
    acted: list[Acted] = field(default_factory=list)

    def take_goals(self, goals: Iterable[tuple[str, Any]], before: int, at: int) -> None:
        """Goals, as (topic, message), that take effect at a period [ns]; `before` as of `late`."""
        self.took += late([(name, goal.stamp) for name, goal in goals], before, at)

    def tell(self) -> dict[str, str]:
        """Values for a heartbeat; what is told is forgotten."""
        values = took_values(self.took) | acted_values(self.acted)
        self.took, self.acted = (), []
        return values


def took_in(values: Mapping[str, str]) -> list[Took]:
    """Goals that a heartbeat tells of. Raises RefusedMessageError for a text that tells of none."""
    found = []
    for key, text in values.items():
        if key.startswith(TOOK):
            for pair in text.split():
                at, _, stamp = pair.partition(":")
                if not (is_count(at) and is_count(stamp)):
                    raise _refusal(key, text, "PERIOD:STAMP, both in nanoseconds")
                found.append(Took(key.removeprefix(TOOK), int(stamp), int(at)))
    return found


def acted_in(values: Mapping[str, str]) -> list[Acted]:
    """Periods that a heartbeat tells of. Raises RefusedMessageError."""
    if ACTED not in values:
        return []
    stamps, told = list[int](), 0
    for behind in _numbers(ACTED, values[ACTED]):
        if behind is None:
            raise _refusal(ACTED, values[ACTED], "whole numbers")
        told += behind
        stamps.append(told)
    ages = {key.removeprefix(HEARD): _numbers(key, text) for key, text in values.items() if key.startswith(HEARD)}
    for name, each in ages.items():
        if len(each) != len(stamps):
            raise _refusal(HEARD + name, values[HEARD + name], f"one for each of {len(stamps)} periods")
    return [
        Acted(at, {name: None if (age := each[index]) is None else at - age for name, each in ages.items()})
        for index, at in enumerate(stamps)
    ]


def _age(acted: Acted, name: str) -> int | None:
    stamp = acted.inputs.get(name)
    return None if stamp is None else acted.at - stamp


def _runs(numbers: Iterable[int | None]) -> str:
    """0*49 1"""
    counted = [(number, len(list(group))) for number, group in groupby(numbers)]
    return " ".join(
        (LOST if number is None else str(number)) + (f"*{count}" if count > 1 else "") for number, count in counted
    )


def _numbers(key: str, text: str) -> Sequence[int | None]:
    found: list[int | None] = []
    for run in text.split():
        number, star, count = run.partition("*")
        times = count if star else "1"
        if not is_count(times) or not (number == LOST or is_count(number.removeprefix("-"))):
            raise _refusal(key, text, "whole numbers, or - for none, each with *COUNT where it stands several times")
        if len(found) + int(times) > MOST_RUNS:
            raise _refusal(key, text, f"at most {MOST_RUNS} numbers")
        found += [None if number == LOST else int(number)] * int(times)
    return found


def _refusal(key: str, text: str, allowed: str) -> RefusedMessageError:
    return RefusedMessageError("/diagnostics", f"status.values.{key}", text[:80], allowed)
