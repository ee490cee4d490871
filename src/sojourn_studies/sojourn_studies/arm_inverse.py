"""Joint positions for a tip pose: scripts/arm_test ARM --to X Y Z ..., and what is done with joints to spare."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sojourn_bringup.screen import wide_console
from sojourn_flight.arm.closed_form import (
    has_spherical_wrist,
    is_planar_with_yaw,
    planar_yaw_branches,
    spherical_wrist_branches,
)
from sojourn_flight.arm.inverse import InverseAnswer, pointing_goal, pose_goal, position_goal
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION
from sojourn_flight.arm.redundancy import (
    Sphere,
    better_posture,
    measure_of,
)
from sojourn_flight.arm.secondary_task import SecondaryTask
from sojourn_flight.arm.self_collision import SelfCollision
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray
from sojourn_studies.arm_report import row_text


@dataclass(frozen=True, slots=True)
class Wish:
    """What is asked of the tip. Neither rotation nor direction: its place alone."""

    position: FloatArray  # (3,) [m]
    rotation: FloatArray | None = None  # (3, 3)
    direction: FloatArray | None = None  # unit (3,)
    prefer: SecondaryTask | None = None
    obstacles: tuple[Sphere, ...] = ()


def inverse_figures(arm: SerialArm, wish: Wish, start: FloatArray | None) -> dict[str, Any]:
    """An answer, all branches where a closed form knows them, and the posture that a secondary task prefers."""
    collides = SelfCollision(arm).text
    branches: Sequence[Any] | None = None
    if wish.rotation is not None:
        task, answer = POSE, pose_goal(arm, wish.position, wish.rotation, start, collides)
        if has_spherical_wrist(arm):
            branches = spherical_wrist_branches(arm, wish.position, wish.rotation, start)
    elif wish.direction is not None:
        task, answer = POINTING, pointing_goal(arm, wish.position, wish.direction, start, collides)
        if is_planar_with_yaw(arm):
            branches = planar_yaw_branches(arm, wish.position, wish.direction, start)
    else:
        task, answer = POSITION, position_goal(arm, wish.position, start, collides)
    result: dict[str, Any] = {
        "status": answer.status,
        "message": answer.message,
        "q": answer.positions.tolist(),
        "position_error_m": answer.position_error,
        "angle_error_rad": answer.angle_error,
    }
    if branches is not None:
        result["branches"] = [
            {"q": branch.positions.tolist(), "inside_limits": branch.inside, "singular": branch.singular}
            for branch in branches
        ]
    if wish.prefer is not None:
        result["secondary"] = _preferred(arm, task, answer, wish, wish.prefer) if answer.reached else None
    return result


def _preferred(arm: SerialArm, task: int, answer: InverseAnswer, wish: Wish, prefer: SecondaryTask) -> dict[str, Any]:
    measure = measure_of(arm, prefer, wish.obstacles)
    better = better_posture(arm, answer.positions, measure, task=task)
    return {
        "prefer": wish.prefer,
        "q": better.tolist(),
        "measure": measure(better),
        "measure_of_first": measure(answer.positions),
    }


def print_inverse(found: dict[str, Any]) -> None:
    """The same in words."""
    console = wide_console()
    message = (
        found["message"] if found["message"].startswith(found["status"]) else f"{found['status']} {found['message']}"
    )
    console.print(f"\ninverse kinematics: {message.strip()}\n    q {row_text(found['q'])}")
    for branch in found.get("branches", ()):
        marks = [] if branch["inside_limits"] else ["beyond the joint limits"]
        marks += ["singular"] if branch["singular"] else []
        console.print(f"    branch {row_text(branch['q'])} {', '.join(marks)}")
    second = found.get("secondary")
    if second is not None:
        first, better = second["measure_of_first"], second["measure"]
        none = "" if better > first else ": this arm has no joint to spare for it here"
        console.print(f"    {second['prefer']}: {row_text(second['q'])} ({first:.4g} to {better:.4g}{none})")
