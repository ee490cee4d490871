"""Velocities that a step keeps saying: the machine drops each after a while, and stands where the next one is late."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from sojourn_config.known_machine import KnownMachine
from sojourn_contract.stamps import NANOSECONDS
from sojourn_operator.steps.begin import BeginStep
from sojourn_operator.steps.step import OperatorStep, View

DROPPED_S: Mapping[str, float] = {"drive": 0.2, "arm": 0.2}
"""Age at which each role drops a velocity, where its machine says no other [s]."""


@runtime_checkable
class Streaming(Protocol):
    """A step that says a velocity again at each look."""

    @property
    def stream_s(self) -> float:
        """For how long [s]."""
        ...


def dropped_s(known: KnownMachine) -> dict[str, float]:
    """Age at which each role of a machine drops a velocity [s]."""
    drive = {} if known.driving is None else {"drive": known.driving.cmd_vel_timeout}
    return {**DROPPED_S, **drive, **({} if known.arm is None else {"arm": known.arm.jog.timeout})}


def stream_s(action: OperatorStep) -> float:
    """How long a step has to say its velocity again and again [s]; 0 for one that says none."""
    if isinstance(action, BeginStep):
        return min(action.seconds, stream_s(action.step.action))
    return action.stream_s if isinstance(action, Streaming) else 0.0


def why_broken(action: OperatorStep, view: View, looked: int, dropped: Mapping[str, float]) -> str:
    """Why the machine has stood meanwhile, as a velocity came too late; "" where it has not.

    Args:
        looked: the look before this one [ns]. dropped: age at which each role drops a velocity [s].
    """
    limit, end = dropped.get(action.role), view.since + round(stream_s(action) * NANOSECONDS)
    if limit is None or min(view.now, end) - looked <= round(limit * NANOSECONDS):
        return ""
    apart = (view.now - looked) / NANOSECONDS
    return (
        f"two velocities were {apart:.2f} s of simulation apart, and the {action.role} drops one after {limit:g} s: "
        "the stack is too fast for velocities (start it with --realtime)"
    )
