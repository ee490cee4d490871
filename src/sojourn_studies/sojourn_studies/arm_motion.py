"""Motions of an arm compared: scripts/arm_test ARM --q ... --move-to ... or --line-to ...

The shapes of profiles.py as fast as the limits of speed and acceleration allow (jerk, for the one that heeds it), and
time-optimal motions under torque, and under power, on the same way.
"""

from typing import Any

import numpy as np
from rich.table import Table

from sojourn_bringup.screen import wide_console
from sojourn_flight.arm.cartesian_path import line
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.friction import friction_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.manipulability import smallest_singular_value
from sojourn_flight.arm.profiles import SHAPES, TimedPath, joint_motion
from sojourn_flight.arm.self_collision import SelfCollision
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_flight.arm.spline_path import SplinePath, chord_length, spline_through
from sojourn_flight.arm.time_optimal import JointLimits, TimingError, fastest_timing
from sojourn_flight.arm.tip_following import CartesianPathError, joints_along
from sojourn_machine.params import FloatArray

SPEED_TIME, JERK_TIME = 0.5, 0.1
"""A joint reaches its speed, and its acceleration, in so long [s]: no URDF tells either."""
_ANY_SPEED = 1.0
"""Speed of a joint that has no limit [rad/s or m/s]."""
_SAMPLES = 400
_SAMPLES = 200
"""Postures of a motion that are looked at for collisions."""


def motion_limits(arm: SerialArm, power: float | None) -> JointLimits:
    """Limits of an arm; power drawn in W, None for any."""
    speed = np.where(np.isfinite(arm.max_velocity), arm.max_velocity, _ANY_SPEED)
    effort = np.where(np.isfinite(arm.max_effort), arm.max_effort, 1e12)
    return JointLimits(speed, speed / SPEED_TIME, effort, np.inf if power is None else power)


def moves_figures(
    arm: SerialArm, start: FloatArray, goal: FloatArray, gravity: FloatArray, power: float | None
) -> dict[str, Any]:
    """Every shape, and the time-optimal motions, from one posture to another."""
    limits = motion_limits(arm, None)
    rows: dict[str, Any] = {}
    for shape in SHAPES:
        motion = joint_motion(shape, start, goal, limits.speed, limits.acceleration, limits.acceleration / JERK_TIME)
        rows[shape] = _loads(arm, motion, gravity)
    points = np.array([start, goal])
    path = spline_through(points, chord_length(points, np.maximum(limits.speed, 1e-9)))
    rows |= _fastest(arm, path, gravity, power)
    way = start + np.linspace(0.0, 1.0, _SAMPLES)[:, None] * (goal - start)
    return _about(arm, start, gravity) | {"to": goal.tolist(), "collision": _collision(arm, way), "motions": rows}


def line_figures(
    arm: SerialArm, start: FloatArray, place: FloatArray, gravity: FloatArray, power: float | None
) -> dict[str, Any]:
    """The tip on a straight line from where it is, turned as it is: as fast as the limits of every joint allow."""
    tip = forward_kinematics(arm, start)
    figures = _about(arm, start, gravity) | {"from_tip_m": tip.position.tolist(), "to_tip_m": place.tolist()}
    try:
        followed = joints_along(arm, line(tip.position, place, tip.rotation, tip.rotation), start)
    except CartesianPathError as error:
        return figures | {"refused": str(error), "collision": "", "motions": {}}
    along = [followed.joints.at(float(u))[0] for u in np.linspace(0.0, followed.joints.end, _SAMPLES)]
    values = [smallest_singular_value(arm, forward_kinematics(arm, q).jacobian) for q in along]
    figures |= {"refused": "", "to": along[-1].tolist(), "smallest_singular_value": min(values)}
    return figures | {
        "collision": _collision(arm, np.array(along)),
        "motions": _fastest(arm, followed.joints, gravity, power),
    }


def _collision(arm: SerialArm, postures: FloatArray) -> str:
    """The first place on a way (m, n) where the arm runs into itself, in words; empty where it does not."""
    look = SelfCollision(arm)
    for k, posture in enumerate(postures):
        found = look.text(posture)
        if found:
            return f"at {100.0 * k / (len(postures) - 1):.0f} % of the way {found}"
    return ""


def _about(arm: SerialArm, start: FloatArray, gravity: FloatArray) -> dict[str, Any]:
    return {"arm": arm.name, "gravity_m_s2": gravity.tolist(), "from": start.tolist()}


def _fastest(arm: SerialArm, path: SplinePath, gravity: FloatArray, power: float | None) -> dict[str, Any]:
    """Time-optimal under torque, and under torque and power."""
    rows: dict[str, Any] = {}
    for name, watts in (("time_optimal", None), *((("time_optimal_power", power),) if power is not None else ())):
        try:
            rows[name] = _loads(arm, fastest_timing(arm, path, motion_limits(arm, watts), gravity), gravity)
        except TimingError as error:
            rows[name] = {"refused": str(error)}
    return rows


def _loads(arm: SerialArm, motion: TimedPath, gravity: FloatArray) -> dict[str, Any]:
    """What a motion takes: shares of the limits, power, work of the motors with none given back."""
    speeds, efforts, powers, tips = [], [], [], []
    times = np.linspace(0.0, motion.duration, _SAMPLES)
    for time in times:
        q, qd, qdd = motion.sample(float(time))
        effort = rigid_effort(arm, q, qd, qdd, gravity) + friction_effort(arm.friction, qd)
        speeds.append(float(np.max(np.abs(qd) / arm.max_velocity)))
        efforts.append(float(np.max(np.abs(effort) / arm.max_effort)))
        powers.append(float(np.sum(np.maximum(effort * qd, 0.0))))
        tips.append(float(np.linalg.norm(forward_kinematics(arm, q).jacobian[:3] @ qd)))
    return {
        "duration_s": motion.duration,
        "largest_share_of_speed": max(speeds),
        "largest_share_of_effort": max(efforts),
        "largest_power_w": max(powers),
        "work_j": float(np.trapezoid(powers, times)),
        "largest_tip_speed_m_s": max(tips),
    }


def print_motions(figures: dict[str, Any]) -> None:
    """The same as a table."""
    console = wide_console()
    if figures.get("refused"):
        console.print(f"{figures['arm']}: the tip cannot follow the line: {figures['refused']}", style="yellow")
        return
    if figures["collision"]:
        console.print(f"the arm collides: {figures['collision']}", style="red")
    if "smallest_singular_value" in figures:
        value = figures["smallest_singular_value"]
        console.print(f"smallest singular value on the line: {value:.3g} (0: singular; the tip is slowed down there)")
    console.print(f"every joint reaches its speed in {SPEED_TIME:g} s, its acceleration in {JERK_TIME:g} s")
    table = Table(title=f"{figures['arm']}: motions on the same way")
    for head in ("motion", "duration [s]", "of speed [%]", "of effort [%]", "power [W]", "work [J]", "tip [m/s]"):
        table.add_column(head, justify="left" if head == "motion" else "right")
    for name, row in figures["motions"].items():
        if "refused" in row:
            table.add_row(name, row["refused"], style="yellow")
            continue
        shares = (100.0 * row["largest_share_of_speed"], 100.0 * row["largest_share_of_effort"])
        rest = (row["largest_power_w"], row["work_j"], row["largest_tip_speed_m_s"])
        style = "red" if shares[1] > 100.5 else None
        table.add_row(name, f"{row['duration_s']:.3f}", *(f"{value:.4g}" for value in (*shares, *rest)), style=style)
    console.print(table)
