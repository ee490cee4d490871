"""What the scripted operator of a scenario sends. Each step is one goal on one topic, or a wait."""

import math
from typing import Literal, Self, TypeAlias

from pydantic import Field, model_validator

from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.tasks.requests import parse_task
from sojourn_machine.params import Params

FARTHEST = 1e6
LONGEST = 1e7
UNIT_TOLERANCE = 1e-3
"""How far the length of a quaternion may be from 1."""


class DriveGoalStep(Params):
    """A pose to drive to: /goal_pose."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    yaw: float | None = Field(
        default=None, ge=-2 * math.pi, le=2 * math.pi, description="heading there; free if left out [rad]"
    )


class PointParams(Params):
    """A point on the way."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")


class DriveRouteStep(Params):
    """Points to drive through, the last one is the goal: /waypoints."""

    points: tuple[PointParams, ...] = Field(min_length=1, max_length=1000, description="points in order")
    yaw: float | None = Field(
        default=None, ge=-2 * math.pi, le=2 * math.pi, description="heading there; free if left out [rad]"
    )


class ArmPoint(Params):
    """A place for the arm's tip, and the direction of its tool there."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    z: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    orientation: tuple[float, float, float, float] = Field(
        default=(0.0, 0.0, 0.0, 1.0),
        description="of the tip frame, quaternion x y z w [-]; 0 0 0 1 leaves the direction of the tool free",
    )

    @model_validator(mode="after")
    def _orientation_is_a_rotation(self) -> Self:
        length = math.hypot(*self.orientation)
        if abs(length - 1.0) > UNIT_TOLERANCE:
            raise ValueError(f"orientation = {self.orientation} has length {length:.4g}: allowed is 1")
        return self


class ArmPoseStep(ArmPoint):
    """A place for the arm's tip: /arm/goal_pose."""

    frame: Literal["base_link", "map"] = Field(default="base_link", description="frame of the numbers")


class ArmGroundStep(Params):
    """A place over the ground: the operator looks its height up and sends /arm/goal_pose."""

    x: float = Field(ge=-10.0, le=10.0, description="position of the target in base_link [m]")
    y: float = Field(ge=-10.0, le=10.0, description="position of the target in base_link [m]")
    height: float = Field(default=0.0, ge=-0.1, le=2.0, description="of the tip above the ground [m]")


class ArmJointsStep(Params):
    """Joint positions, or the name of a pose of the arm: /arm/joint_goal."""

    name: str | None = Field(default=None, min_length=1, description="named pose of the arm: stow, unfold")
    positions: tuple[float, ...] | None = Field(
        default=None, min_length=1, description="one for each joint, in the order of the arm [rad]"
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.name is None) == (self.positions is None):
            raise ValueError("allowed is either name or positions")
        return self


class ArmPathPoint(ArmPoint):
    """A point of a path of the arm's tip."""

    on_arc: bool = Field(default=False, description="gone by on an arc, from the point before to the one after")


class ArmPathStep(Params):
    """Straight lines and arcs of the arm's tip, from where it is: /arm/path."""

    frame: Literal["base_link", "map"] = Field(default="base_link", description="frame of the numbers")
    points: tuple[ArmPathPoint, ...] = Field(min_length=1, max_length=1000, description="points in order")

    @model_validator(mode="after")
    def _arcs_have_ends(self) -> Self:
        for k, point in enumerate(self.points):
            if point.on_arc and (k + 1 == len(self.points) or self.points[k + 1].on_arc):
                raise ValueError(f"points[{k}] is on an arc: allowed is one such point, then the arc's end")
        return self


class ArmJogStep(Params):
    """A velocity that the operator keeps sending for a while, then zero: /arm/cmd_vel."""

    linear: tuple[float, float, float] = Field(default=(0.0, 0.0, 0.0), description="velocity of the tip [m/s]")
    angular: tuple[float, float, float] = Field(default=(0.0, 0.0, 0.0), description="rate of its turn [rad/s]")
    frame: str = Field(
        default="base_link", description="frame of the numbers: base_link, map, odom or the link of the arm's tip"
    )
    seconds: float = Field(gt=0.0, le=LONGEST, description="how long [s]")


class ArmTaskStep(Params):
    """A task of the arm with its numbers: /arm/task."""

    name: str = Field(min_length=1, description="name of the task: guarded_move, ...")
    values: dict[str, bool | float | tuple[float, ...]] = Field(default_factory=dict, description="its numbers, by key")

    @model_validator(mode="after")
    def _task_is_known(self) -> Self:
        try:
            parse_task(self.name, self.texts)
        except GoalRefusedError as error:
            raise ValueError(str(error)) from error
        return self

    @property
    def texts(self) -> dict[str, str]:
        """The numbers as /arm/task carries them."""
        return {key: _text(value) for key, value in self.values.items()}


def _text(value: bool | float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return " ".join(f"{number:g}" for number in value)
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


StepAction: TypeAlias = (
    DriveGoalStep
    | DriveRouteStep
    | ArmPoseStep
    | ArmGroundStep
    | ArmJointsStep
    | ArmPathStep
    | ArmJogStep
    | ArmTaskStep
    | float
)
ACTIONS = (
    "drive_to",
    "drive_route",
    "arm_to",
    "arm_to_ground",
    "arm_joints",
    "arm_path",
    "arm_jog",
    "arm_task",
    "wait_s",
)


class StepConfig(Params):
    """One step: exactly one of its actions, and how long it may take."""

    drive_to: DriveGoalStep | None = Field(default=None, description="drive to a pose")
    drive_route: DriveRouteStep | None = Field(default=None, description="drive through points")
    arm_to: ArmPoseStep | None = Field(default=None, description="tip of the arm to a place")
    arm_to_ground: ArmGroundStep | None = Field(default=None, description="tip of the arm to the ground")
    arm_joints: ArmJointsStep | None = Field(default=None, description="arm to positions or a named pose")
    arm_path: ArmPathStep | None = Field(default=None, description="tip of the arm along lines and arcs")
    arm_jog: ArmJogStep | None = Field(default=None, description="tip of the arm with a velocity, for a while")
    arm_task: ArmTaskStep | None = Field(default=None, description="task of the arm")
    wait_s: float | None = Field(default=None, ge=0.0, le=LONGEST, description="time to wait [s]")
    timeout_s: float | None = Field(
        default=None, gt=0.0, le=LONGEST, description="time until the step has failed [s]; none: no limit"
    )

    @model_validator(mode="after")
    def _one_action(self) -> Self:
        given = [name for name in ACTIONS if getattr(self, name) is not None]
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            raise ValueError(f"a step has one action, here {found}: allowed is one of " + ", ".join(ACTIONS))
        return self

    @property
    def kind(self) -> str:
        """Name of the action: one of ACTIONS."""
        return next(name for name in ACTIONS if getattr(self, name) is not None)

    @property
    def action(self) -> StepAction:
        """What is to be done; for `wait_s` the seconds."""
        action: StepAction = getattr(self, self.kind)
        return action
