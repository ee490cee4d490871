"""What is under way over the arm's laws, as one of several values: each holds what it needs, and nothing else.

NoTask -> RunningTask <-> GuidedTask <-> PausedTask, and from any of them to a Jog and back.
"""

from dataclasses import dataclass, field
from typing import TypeAlias

from sojourn_flight.arm.jogging import Jogging
from sojourn_flight.arm.tasks.guided_pace import GuidedPace
from sojourn_flight.arm.tasks.task import Doing, Task
from sojourn_flight.arm.tasks.tip_motion import TipMotion


@dataclass(frozen=True, slots=True)
class NoTask:
    """The last goal was one of the arm, or there was none."""


@dataclass(frozen=True, slots=True)
class RunningTask:
    """A task that moves the arm by goals, or not at all; also one that has ended."""

    name: str
    task: Task
    doing: Doing


@dataclass(frozen=True, slots=True)
class GuidedTask(RunningTask):
    """A task that gives the reference of the tip."""

    motion: TipMotion
    pace: GuidedPace = field(default_factory=GuidedPace)


@dataclass(frozen=True, slots=True)
class PausedTask(GuidedTask):
    """The tip comes to rest, or rests; the task stands still."""


@dataclass(frozen=True, slots=True)
class Jog:
    """The tip is moved by hand."""

    jogging: Jogging
    doing: Doing
    motion: TipMotion | None
    """None once the arm rests."""


Activity: TypeAlias = NoTask | RunningTask | GuidedTask | PausedTask | Jog


def name_of(activity: Activity) -> str:
    """Of the task, or jog; empty where there is none."""
    if isinstance(activity, RunningTask):
        return activity.name
    return "jog" if isinstance(activity, Jog) else ""


def motion_of(activity: Activity) -> TipMotion | None:
    """Of the tip's reference; None where none is given to the arm."""
    return activity.motion if isinstance(activity, GuidedTask | Jog) else None
