"""What the arm is about, as one of several values: each holds what that phase needs, and nothing else.

Waiting -> Holding -> Moving -> Settling -> Holding
                      Moving -> Pausing -> Paused -> Moving
                      any of them -> Stopping -> Holding
                      any of them -> Guided, while a task gives the reference
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.path_clock import PathClock
from sojourn_flight.arm.ways import Plan

RestStatus: TypeAlias = Literal["idle", "holding", "refused", "reached", "stopped"]
ArmStatus: TypeAlias = Literal["moving", "paused"] | RestStatus


@dataclass(frozen=True, slots=True)
class Waiting:
    """Nothing has been measured yet."""


@dataclass(frozen=True, slots=True)
class Holding:
    """At rest; no goal is under way."""

    status: RestStatus
    """What became of the last one."""


@dataclass(frozen=True, slots=True)
class Guided:
    """A task gives the reference."""


@dataclass(frozen=True, slots=True)
class Moving:
    """On the path of a plan."""

    plan: Plan
    clock: PathClock
    """Where on the path, and at which rate: 1 as planned, 0 at rest on it."""
    pace: float = 1.0
    """The rate that the granted power allows."""


@dataclass(frozen=True, slots=True)
class Pausing(Moving):
    """Coming to rest on the path."""


@dataclass(frozen=True, slots=True)
class Paused(Moving):
    """At rest on the path."""


@dataclass(frozen=True, slots=True)
class Stopping:
    """Coming to rest as fast as the limits allow, off any plan."""

    path: JointPath
    time: float = 0.0
    """On it [s]."""


@dataclass(frozen=True, slots=True)
class Settling:
    """The reference is at its target, the joints have yet to arrive."""

    within_for: float = 0.0
    """How long they have been within tolerance [s]."""
    elapsed: float = 0.0
    """[s]"""


Phase: TypeAlias = Waiting | Holding | Guided | Moving | Pausing | Paused | Stopping | Settling


def status_of(phase: Phase) -> ArmStatus:
    """The phase in the words of the status."""
    if isinstance(phase, Holding):
        return phase.status
    if isinstance(phase, Waiting):
        return "idle"
    return "paused" if isinstance(phase, Paused) else "moving"


def is_busy(phase: Phase) -> bool:
    """Whether a planned motion, or a stop, is under way."""
    return isinstance(phase, Moving | Stopping | Settling)
