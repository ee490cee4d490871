"""What a step of a script may ask for: goals of drive and arm, and waits."""

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class DriveTo:
    """Drive to a point of the map [m]; `yaw` [rad] is the wanted heading there, None for any."""

    x: float
    y: float
    yaw: float | None = None
    frame: str = "map"
    z: float = 0.0
    """Height of the ground there over that of the start [m], 0 if it is not known."""


@dataclass(frozen=True)
class DriveAlong:
    """Drive along points (x, y) of the map [m]; `yaw` [rad] is the wanted heading at the last, None for any."""

    points: tuple[tuple[float, float], ...]
    yaw: float | None = None
    frame: str = "map"


@dataclass(frozen=True)
class ArmTo:
    """Place the arm's tip at a point [m]; an orientation of 0 0 0 1 (x y z w) leaves the direction of the tool free."""

    x: float
    y: float
    z: float
    frame: str = "base_link"
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class ArmGround:
    """Place the arm's tip `height` over the ground at (x, y) of base_link [m]; whoever sends it looks the ground up."""

    x: float
    y: float
    height: float = 0.0


@dataclass(frozen=True)
class ArmJoints:
    """Move the arm to joint positions [rad], by joint name, or to a named pose (stow, unfold)."""

    positions: tuple[tuple[str, float], ...] = ()
    name: str = ""


@dataclass(frozen=True)
class TipPoint:
    """A point of a path of the arm's tip [m]; an orientation of 0 0 0 1 (x y z w) keeps the direction of the tool."""

    x: float
    y: float
    z: float
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    on_arc: bool = False


@dataclass(frozen=True)
class ArmAlong:
    """Move the arm's tip along straight lines through points, and on arcs by way of those on one."""

    points: tuple[TipPoint, ...]
    frame: str = "base_link"


@dataclass(frozen=True)
class ArmJog:
    """Move the arm's tip with a velocity [m/s] and a rate of turn [rad/s] for a while [s]."""

    linear: tuple[float, float, float]
    angular: tuple[float, float, float]
    seconds: float
    frame: str = "base_link"

    @property
    def over(self) -> "ArmJog":
        """What is asked for at its end: to rest."""
        return replace(self, linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0))


@dataclass(frozen=True)
class ArmTask:
    """Carry out a task of the arm with its numbers, as texts by key."""

    name: str
    values: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Wait:
    """Do nothing for a while [s]."""

    seconds: float


Action = DriveTo | DriveAlong | ArmTo | ArmGround | ArmJoints | ArmAlong | ArmJog | ArmTask | Wait

TOPICS: dict[type, tuple[str, str]] = {
    DriveTo: ("/goal_pose", "drive"),
    DriveAlong: ("/waypoints", "drive"),
    ArmTo: ("/arm/goal_pose", "arm"),
    ArmGround: ("/arm/goal_pose", "arm"),
    ArmJoints: ("/arm/joint_goal", "arm"),
    ArmAlong: ("/arm/path", "arm"),
    ArmJog: ("/arm/cmd_vel", "arm"),
    ArmTask: ("/arm/task", "arm"),
}
"""Topic of each kind of goal, and the role that carries it out."""


def describe(action: Action) -> str:
    """The action in a few words."""
    match action:
        case DriveTo(x, y, yaw):
            return f"drive to ({x:.2f}, {y:.2f})" + ("" if yaw is None else f" heading {yaw:.2f} rad")
        case DriveAlong(points):
            return f"drive along {len(points)} points"
        case ArmTo(x, y, z):
            return f"arm to ({x:.3f}, {y:.3f}, {z:.3f})"
        case ArmGround(x, y, height):
            return f"arm to the ground at ({x:.2f}, {y:.2f})" + (f", {height:.3f} m above it" if height else "")
        case ArmJoints(positions, name):
            return f"arm: {name}" if name else f"arm to {len(positions)} joint positions"
        case ArmAlong(points):
            return f"arm along {len(points)} points"
        case ArmJog(linear, angular, seconds):
            return f"jog the arm at {math.hypot(*linear):g} m/s, {math.hypot(*angular):g} rad/s for {seconds:g} s"
        case ArmTask(name, values):
            return " ".join((f"arm: {name}", *(f"{key}={value}" for key, value in values)))
        case Wait(seconds):
            return f"wait {seconds:g} s"


def receiver_of(action: Action) -> str:
    """Role that carries out an action, "" for a wait."""
    return "" if isinstance(action, Wait) else TOPICS[type(action)][1]
