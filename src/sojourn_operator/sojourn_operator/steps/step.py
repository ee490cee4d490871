"""What a step of a scenario is to the scripted operator: what it says when, and how it ended.

A kind of step is a pydantic model, its fields the words of the file, with the methods of `OperatorStep`, registered by
an entry point of the group `sojourn.steps`. It remembers nothing: all that it goes by is in the `View`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from sojourn_config.steps import Step
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import OPERATOR_LAG
from sojourn_contract.values import Message, Odometry

if TYPE_CHECKING:
    from sojourn_physics.terrain.height_field import HeightField

REACHED, REFUSED, STOPPED = "reached", "refused", "stopped"
WAITED = "waited"
JOGGED = "jogged"
DONE = "done"
GOOD_OUTCOMES = (REACHED, WAITED, JOGGED, DONE)
"""Of a step that did what it was to do; DONE is for kinds that have no better word."""
FINAL_STATES = (REACHED, REFUSED, STOPPED, "failed")
"""Of a goal that drive or arm is through with."""
LEAD_NS = OPERATOR_LAG * CONTROL_PERIOD_NS
"""A goal takes effect so much after the look that led to it [ns]."""


@dataclass(frozen=True)
class GoalReport:
    """What drive or arm says of its goal.

    Args:
        state: word of the status. goal_stamp: stamp of the goal that it is about [ns], 0 for none. reason: in words.
    """

    state: str
    goal_stamp: int
    reason: str = ""


@dataclass(frozen=True)
class RunFacts:
    """What does not change in a run.

    Args:
        arm_joints: names, none where there is no arm.
        terrain: the ground; None where no step looks at it.
    """

    arm_joints: tuple[str, ...] = ()
    terrain: "HeightField | None" = None


@dataclass(frozen=True)
class View:
    """What a step goes by at a look.

    Args:
        since, now: simulation time at which it began, and now [ns].
        reports: last word of "drive" and "arm", where there is one.
        truth: where the machine truly is, as a person beside it sees it; over a link to Earth the last /odom that has
            come down. None until it has been told.
    """

    since: int
    now: int
    reports: Mapping[str, GoalReport]
    around: RunFacts
    truth: Odometry | None = None

    @property
    def begins(self) -> bool:
        """Whether this is the step's first look."""
        return self.now == self.since

    @property
    def stamp(self) -> int:
        """Of what is said at this look [ns]."""
        return self.now + LEAD_NS

    def is_over(self, seconds: float) -> bool:
        """Whether it has lasted so long [s]."""
        return self.now >= self.since + round(seconds * NANOSECONDS)

    def over_ground(self, x: float, y: float, height: float) -> tuple[float, float, float]:
        """Point of base_link at x, y of it [m], so high over the ground along the vertical [m].

        It is looked up in the scenario's terrain from the true pose, as a person would pick a target in the picture of
        the stereo cameras.

        Raises:
            OutsideTerrainError: there is no ground there. ValueError: nobody looks at the ground in this run.
        """
        if self.around.terrain is None or self.truth is None:
            raise ValueError("no ground to look at: a kind of step that needs it says looks_at_ground = True")
        from sojourn_operator.ground import ground_point  # here: it loads what most nodes do without

        return ground_point(self.around.terrain, self.truth.position, self.truth.orientation, (x, y, height))


class OperatorStep(Step):
    """A step as the scripted operator carries it out: by default one goal, over when its role is through with it."""

    looks_at_ground: ClassVar[bool] = False
    """Whether it has to know where the ground is."""

    def describe(self) -> str:
        """What is to be done, in a few words."""
        raise NotImplementedError

    def goal(self, view: View) -> Message | None:
        """With what it begins, for its topic, stamped `view.stamp`; None: with nothing."""
        return None

    def say(self, view: View) -> Message | None:
        """What goes out on its topic at a look; None: nothing."""
        return self.goal(view) if view.begins else None

    def rests_until(self, view: View) -> int | None:
        """Simulation time until which it says nothing and looks at nothing [ns], so that the clock may leap; None where
        that cannot be told.
        """
        return None

    def end(self, view: View) -> tuple[str, str] | None:
        """Outcome and reason at a look after the first one, None while it goes on.

        An outcome other than GOOD_OUTCOMES says that the step has failed, which ends the script.
        """
        report = view.reports.get(self.role)
        if report is None or report.goal_stamp != view.since + LEAD_NS or report.state not in FINAL_STATES:
            return None
        return report.state, report.reason
