"""Figures of an arm for people and for programs: keys with their units, a table in words."""

from typing import Any

import numpy as np
from rich.table import Table

from sojourn_bringup.screen import wide_console
from sojourn_flight.arm.dh import DhGeometry
from sojourn_flight.arm.manipulability import partial_manipulability
from sojourn_flight.arm.orientation import orientation_of
from sojourn_flight.arm.posture import Posture
from sojourn_flight.arm.self_collision import SelfCollision
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray


def figures_of(
    arm: SerialArm, q: FloatArray, qd: FloatArray, qdd: FloatArray, gravity: FloatArray, found: Posture
) -> dict[str, Any]:
    """The figures under the keys above; plain values."""
    form = found.orientation
    condition = found.condition_number
    return {
        "arm": arm.name,
        "joints": list(arm.joint_names),
        "joint_kinds": ["revolute" if turns else "prismatic" for turns in arm.revolute],
        "q": q.tolist(),
        "qd": qd.tolist(),
        "qdd": qdd.tolist(),
        "gravity_m_s2": gravity.tolist(),
        "payload_kg": 0.0,
        "tip_position_m": found.tip.position.tolist(),
        "tip_quaternion_xyzw": form.quaternion_xyzw.tolist(),
        "tip_rotation": found.tip.rotation.tolist(),
        "tip_rotation_vector_rad": form.rotation_vector.tolist(),
        "tip_roll_pitch_yaw_rad": form.roll_pitch_yaw.tolist(),
        "tip_euler_zyz_rad": form.euler_zyz.tolist(),
        "orientation_singularities": list(form.singularities),
        "jacobian": found.tip.jacobian.tolist(),
        "mass_matrix_kg_m2": found.mass_matrix.tolist(),
        "gravity_torques_n_m": found.gravity_effort.tolist(),
        "coriolis_torques_n_m": found.coriolis_effort.tolist(),
        "friction_torques_n_m": found.friction_effort.tolist(),
        "inverse_dynamics_n_m": found.inverse_dynamics.tolist(),
        "drive_torques_n_m": found.drive_effort.tolist(),
        "manipulability": found.manipulability,
        "manipulability_translation": partial_manipulability(arm, found.tip.jacobian, slice(0, 3)),
        "manipulability_rotation": partial_manipulability(arm, found.tip.jacobian, slice(3, 6)),
        "smallest_singular_value": found.smallest_singular_value,
        "condition_number": condition if np.isfinite(condition) else None,
        "largest_payload_kg": found.largest_payload if _is_finite(found.largest_payload) else None,
        "collision": SelfCollision(arm).text(q),
        "beyond_limits": list(found.beyond_limits),
        "overloaded": list(found.overloaded),
    }


def dh_figures(arm: SerialArm, tables: dict[str, DhGeometry]) -> dict[str, Any]:
    """Both tables of an arm; angles in rad."""
    result: dict[str, Any] = {"arm": arm.name, "joints": list(arm.joint_names)}
    for kind, table in tables.items():
        a, alpha = _columns(kind, table)
        result[kind] = {
            "theta_rad": table.theta.tolist(),
            "d_m": table.d.tolist(),
            "a_m": a.tolist(),
            "alpha_rad": alpha.tolist(),
            "transform_base": table.base.tolist(),
            "transform_tool": table.tool.tolist(),
        }
    return result


def print_dh(arm: SerialArm, tables: dict[str, DhGeometry]) -> None:
    """Both tables in words; angles in degrees."""
    console = wide_console()
    for kind, geometry in tables.items():
        a, alpha = _columns(kind, geometry)
        sub = "i" if kind == "standard" else "i-1"
        table = Table(title=f"{arm.name}: {kind} Denavit-Hartenberg table (q is added where it stands)")
        for head in ("joint", "theta_i [deg]", "d_i [m]", f"a_{sub} [m]", f"alpha_{sub} [deg]"):
            table.add_column(head, justify="left" if head == "joint" else "right")
        for i, name in enumerate(arm.joint_names):
            theta, d = f"{np.degrees(geometry.theta[i]) + 0.0:.5g}", f"{geometry.d[i] + 0.0:.6g}"
            turns = arm.revolute[i]
            row = (f"q + {theta}" if turns else theta, d if turns else f"q + {d}")
            table.add_row(name, *row, f"{a[i] + 0.0:.6g}", f"{np.degrees(alpha[i]) + 0.0:.5g}")
        console.print(table)
        for what, transform in (("frame 0 in the base", geometry.base), ("tip in the last frame", geometry.tool)):
            rpy = np.degrees(orientation_of(transform[:3, :3]).roll_pitch_yaw)
            console.print(f"{what}: xyz {row_text(transform[:3, 3])} m, roll pitch yaw {row_text(rpy)} deg")


def print_figures(figures: dict[str, Any]) -> None:
    """The figures of a posture in words."""
    console = wide_console()
    joints = Table(title=f"{figures['arm']}: joints")
    heads = ("joint", "q", "qd", "qdd", "gravity", "Coriolis", "friction", "M qdd + C qd + g", "drive")
    for head in heads:
        joints.add_column(head, justify="left" if head == "joint" else "right")
    torques = ("gravity_torques_n_m", "coriolis_torques_n_m", "friction_torques_n_m")
    keys = ("q", "qd", "qdd", *torques, "inverse_dynamics_n_m", "drive_torques_n_m")
    for i, name in enumerate(figures["joints"]):
        joints.add_row(name, *(_number(figures[key][i]) for key in keys))
    console.print(joints)
    kinds = set(figures["joint_kinds"])
    units = {"revolute": "rad, N m", "prismatic": "m, N"}
    console.print("units: " + "; ".join(f"{kind} {units[kind]}" for kind in sorted(kinds, reverse=True)))
    gravity, payload = row_text(figures["gravity_m_s2"]), figures["payload_kg"]
    console.print(f"gravity {gravity} m/s2 in the base, payload {payload:g} kg\n")
    console.print(f"tip position      {row_text(figures['tip_position_m'])} m")
    console.print(f"    quaternion    {row_text(figures['tip_quaternion_xyzw'])} (x y z w)")
    console.print(f"    roll pitch yaw {row_text(figures['tip_roll_pitch_yaw_rad'])} rad")
    for text in figures["orientation_singularities"]:
        console.print(f"    not unique here: {text}")
    console.print(_matrix("Jacobian", figures["jacobian"], figures["joints"], ("vx", "vy", "vz", "wx", "wy", "wz")))
    console.print(_matrix("mass matrix", figures["mass_matrix_kg_m2"], figures["joints"], figures["joints"]))
    smallest = figures["smallest_singular_value"]
    moving, turning = figures["manipulability_translation"], figures["manipulability_rotation"]
    console.print(
        f"manipulability {figures['manipulability']:.4g} (of translation {moving:.4g}, of rotation {turning:.4g}), "
        f"smallest singular value {smallest:.4g}"
    )
    if figures["largest_payload_kg"] is not None:
        console.print(f"largest further payload held here: {figures['largest_payload_kg']:.4g} kg")
    for key, words in (("beyond_limits", "beyond its range"), ("overloaded", "asked for more than it can give")):
        for text in figures[key]:
            console.print(f"{words}: {text}", style="yellow")
    if figures["collision"]:
        console.print(f"collides: {figures['collision']}", style="yellow")


def _matrix(title: str, rows: list[list[float]], columns: list[str], names: Any) -> Table:
    table = Table(title=title)
    table.add_column("")
    for column in columns:
        table.add_column(column, justify="right")
    for name, row in zip(names, rows, strict=True):
        table.add_row(name, *(_number(value) for value in row))
    return table


def _columns(kind: str, table: DhGeometry) -> tuple[FloatArray, FloatArray]:
    """Columns a and alpha of a convention, (n,) each."""
    return (table.a[1:], table.alpha[1:]) if kind == "standard" else (table.a[:-1], table.alpha[:-1])


def row_text(values: Any) -> str:
    return " ".join(_number(value) for value in values)


def _number(value: float) -> str:
    """Four decimals, or five digits of what is large; no minus before a zero."""
    return f"{round(float(value), 4) + 0.0:.4f}" if abs(value) < 1e5 else f"{value:.5g}"


def _is_finite(value: float | None) -> bool:
    return value is not None and bool(np.isfinite(value))
