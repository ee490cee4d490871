"""A drive whose law is its own: what the plant asks of it at each physics step, and what it tells.

    push     torque T on the joint at its present rate, and how it falls with the rate: T(q' + dq') = T - s dq', s >= 0
    settle   when the machine has been solved with it: the torque that was applied, and the motion that came of it;
             from them the drive's own state at the end of the step, the power that it takes from its bus and its heat

What it takes is work + heat + change of what it stores; the plant's energy account holds it to that. A stiff law gives
its slope s, which makes it implicit; one without has to be slow against the step. Friction of the joint's bearing is
that of any joint without a motor (`passive_joint`), its stops are the joint's own.

A kind of drive is parameters derived from `ActuatorParams`, whose `actuator` makes one of these for a joint; they are
registered by an entry point of the group `sojourn.actuators`. A state is a plain value (numbers, tuples, arrays: what
a checkpoint can keep) that nobody changes: a step gives a new one. Motor, gear and servo (`joint_drive`) are solved by
the kernels instead, with all joints at once.
"""

from abc import ABC, abstractmethod
from typing import Generic, NamedTuple, TypeVar

State = TypeVar("State")


class JointOrder(NamedTuple):
    """What a joint is told at a step."""

    position: float
    """As commanded, moved on at the commanded rate since then [rad]."""
    rate: float
    """[rad/s]"""
    effort: float
    """Feed-forward [N m]."""
    supply: float
    """Part of its current that the drive may draw: 0 is switched off, or dead, 1 all of it."""
    voltage: float
    """Of the bus that feeds it [V]."""


class JointMotion(NamedTuple):
    """Of the joint: angle at the start of the step, or at its end [rad], rates at both [rad/s]."""

    angle: float
    rate: float
    """At the start."""
    new_rate: float
    """At the end; before the machine is solved, as at the start."""

    @property
    def mean_rate(self) -> float:
        """In the step; the work of a torque is torque times this times dt [rad/s]."""
        return 0.5 * (self.rate + self.new_rate)


class Push(NamedTuple):
    """What a drive gives its joint."""

    torque: float
    """[N m]"""
    slope: float = 0.0
    """s, not negative [N m s/rad]."""


class Drawn(NamedTuple):
    """What a drive takes in a step."""

    power: float
    """From its bus; negative where it gives back [W]."""
    heat: float
    """Not negative [W]."""
    current: float = 0.0
    """As telemetry has it [A]."""


class Actuator(ABC, Generic[State]):
    """The drive of one joint."""

    @abstractmethod
    def initial_state(self, angle: float) -> State:
        """At rest, the joint at an angle [rad]."""

    @abstractmethod
    def push(self, state: State, told: JointOrder, joint: JointMotion, dt: float) -> Push:
        """Torque on the joint for a step of `dt` [s]."""

    @abstractmethod
    def settle(
        self, state: State, told: JointOrder, joint: JointMotion, torque: float, dt: float
    ) -> tuple[State, Drawn]:
        """After the step.

        Args:
            joint: its angle at the end. torque: that was applied, T - s dq' [N m].
        """

    def stored(self, state: State) -> float:
        """Energy that it holds: of springs, rotors, pressure [J]."""
        del state
        return 0.0
