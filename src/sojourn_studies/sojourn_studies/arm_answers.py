"""What is asked of an arm on the bench, answered in words or as JSON: the work of scripts/arm_test."""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sojourn_analysis.arm.control_loop import ControlTestError
from sojourn_config import command_line
from sojourn_config.arms import load_arm
from sojourn_config.command_errors import UsageError
from sojourn_flight.arm.dh_extract import dh_of_chain
from sojourn_flight.arm.orientation import (
    from_euler_zyz,
    from_quaternion,
    from_roll_pitch_yaw,
    from_rotation_vector,
)
from sojourn_flight.arm.posture import posture
from sojourn_flight.arm.redundancy import Sphere
from sojourn_flight.arm.serial_arm import SerialArm, with_payload
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_studies.arm_control import compare_laws, print_comparison
from sojourn_studies.arm_inverse import Wish, inverse_figures, print_inverse
from sojourn_studies.arm_motion import line_figures, moves_figures, print_motions
from sojourn_studies.arm_report import dh_figures, figures_of, print_dh, print_figures
from sojourn_studies.arm_test import EARTH

_TURNS = {
    "rpy": (3, from_roll_pitch_yaw),
    "quaternion": (4, from_quaternion),
    "rotation_vector": (3, from_rotation_vector),
    "euler": (3, from_euler_zyz),
}
"""Options that turn the tip: how many numbers, and what makes a matrix of them."""


def _draw(arm: SerialArm, gravity: FloatArray, given: argparse.Namespace) -> int:
    from sojourn_analysis.arm.workspace import workspace_map
    from sojourn_studies.arm_picture import draw_workspace, usual_payload

    path: Path = given.workspace
    if path.suffix.lower() not in (".png", ".pdf", ".svg", ".jpg"):
        raise UsageError(f"arm_test: --workspace {path}: allowed is a file that ends in .png, .jpg, .pdf or .svg")
    if not path.parent.is_dir():
        raise UsageError(f"arm_test: --workspace {path}: there is no folder {path.parent}")
    found = workspace_map(arm, gravity)
    stance = _joints(arm, given, "q") if given.q is not None else 0.5 * (arm.lower + arm.upper)
    draw_workspace(arm, found, gravity, stance, path)
    if given.json:
        summary = {
            "arm": arm.name,
            "picture": str(path),
            "reach_from_axis_m": found.reach_from_axis,
            "volume_m3": found.volume,
            "largest_manipulability": _largest(found.manipulability),
            "largest_force_any_direction_n": _largest(found.force),
            "largest_payload_kg": None if found.payload is None else _largest(found.payload),
            "payload_in_95_percent_kg": None if found.payload is None else usual_payload(found.payload),
            "force_without_weight": found.weightless,
        }
        print(json.dumps(summary, indent=2))
    else:
        print(f"workspace of {arm.name}: {path}")
    return 0


def _largest(values: FloatArray) -> float | None:
    """Largest of a map; None where there is no bound, or nothing."""
    finite = values[~np.isnan(values)]
    return float(finite.max()) if finite.size and np.isfinite(finite.max()) else None


def _compare(arm: SerialArm, gravity: FloatArray, given: argparse.Namespace) -> int:
    (error,) = _numbers(given.mass_error, "--mass-error", 1)
    if not -1.0 < error <= 10.0:
        raise UsageError(f"arm_test: --mass-error {error:g}: allowed is a share above -1, at most 10")
    try:
        figures = compare_laws(arm, gravity, error)
    except ControlTestError as problem:
        raise UsageError(f"arm_test: {problem} (see --gravity)") from problem
    if given.json:
        print(json.dumps(figures, indent=2))
    else:
        print_comparison(figures)
    return 0


def _move(arm: SerialArm, gravity: FloatArray, given: argparse.Namespace) -> int:
    if given.move_to is not None and given.line_to is not None:
        raise UsageError("arm_test: --move-to and --line-to: allowed is one of the two")
    power = None if given.power is None else _numbers(given.power, "--power", 1)[0]
    if power is not None and power <= 0.0:
        raise UsageError(f"arm_test: --power {power:g}: allowed is a number above 0 W")
    start = _joints(arm, given, "q")
    if given.move_to is not None:
        figures = moves_figures(arm, start, _joints(arm, given, "move_to"), gravity, power)
    else:
        figures = line_figures(arm, start, np.array(_numbers(given.line_to, "--line-to", 3)), gravity, power)
    if given.json:
        print(json.dumps(figures, indent=2))
    else:
        print_motions(figures)
    return 0


def _inverse(arm: SerialArm, given: argparse.Namespace, start: FloatArray | None) -> dict[str, object]:
    turns = [name for name in ("pointing", *_TURNS) if getattr(given, name) is not None]
    if len(turns) > 1:
        raise UsageError(f"arm_test: {' and '.join(_option(name) for name in turns)}: allowed is one of them")
    direction = rotation = None
    if turns == ["pointing"]:
        direction = np.array(_numbers(given.pointing, "--pointing", 3))
        if not np.any(direction):
            raise UsageError("arm_test: --pointing 0 0 0: allowed is a direction")
        direction /= np.linalg.norm(direction)
    elif turns:
        count, to_matrix = _TURNS[turns[0]]
        values = np.array(_numbers(getattr(given, turns[0]), _option(turns[0]), count))
        try:
            rotation = to_matrix(np.radians(values) if given.degrees and count == 3 else values)
        except InvalidValueError as error:
            raise UsageError(f"arm_test: {_option(turns[0])}: {error}") from error
    wish = Wish(np.array(_numbers(given.to, "--to", 3)), rotation, direction, given.prefer, tuple(_obstacles(given)))
    return inverse_figures(arm, wish, start)


def _obstacles(given: argparse.Namespace) -> Iterator[Sphere]:
    if (given.prefer == "clear") != (given.obstacle is not None):
        raise UsageError("arm_test: --prefer clear and --obstacle: allowed are both or neither")
    for texts in given.obstacle or ():
        *centre, radius = _numbers(texts, "--obstacle", 4)
        if radius < 0.0:
            raise UsageError(f"arm_test: --obstacle: radius {radius:g}: allowed is at least 0 m")
        yield Sphere(np.array(centre), radius)


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")


def _loaded(arm: SerialArm, given: argparse.Namespace) -> SerialArm:
    if given.payload is None:
        raise UsageError("arm_test: --payload-at goes with --payload")
    (mass,) = _numbers(given.payload, "--payload", 1)
    if mass < 0.0:
        raise UsageError(f"arm_test: --payload {mass:g}: allowed is a mass of at least 0 kg")
    x, y, z = (0.0, 0.0, 0.0) if given.payload_at is None else _numbers(given.payload_at, "--payload-at", 3)
    return with_payload(arm, mass, (x, y, z))


def _gravity(texts: list[str] | None) -> FloatArray:
    """The vector in the base (3,) [m/s2]."""
    if texts is None:
        return np.array([0.0, 0.0, -EARTH])
    values = _numbers(texts, "--gravity", None)
    if len(values) == 1 and values[0] >= 0.0:
        return np.array([0.0, 0.0, -values[0]])
    if len(values) == 3:
        return np.array(values)
    given = " ".join(f"{value:g}" for value in values)
    raise UsageError(f"arm_test: --gravity {given}: allowed is one number of at least 0, or three")


def _joints(arm: SerialArm, given: argparse.Namespace, name: str) -> FloatArray:
    """Values of --q, --qd, --qdd or --move-to (n,) [rad or m, per s, per s2]."""
    texts = getattr(given, name)
    if texts is None:
        return np.zeros(arm.joint_count)
    values = np.array(_numbers(texts, _option(name), None))
    if len(values) != arm.joint_count:
        raise UsageError(
            f"arm_test: {_option(name)} has {len(values)} values: {arm.name} has {arm.joint_count} joints "
            f"({', '.join(arm.joint_names)})"
        )
    return np.where(arm.revolute, np.radians(values), values) if given.degrees else values


def _numbers(texts: list[str] | str, option: str, count: int | None) -> list[float]:
    """Finite numbers, separated by blanks or commas."""
    words = [word for text in ([texts] if isinstance(texts, str) else texts) for word in text.replace(",", " ").split()]
    try:
        values = [command_line.number(word) for word in words]
    except argparse.ArgumentTypeError as error:
        raise UsageError(f"arm_test: {option}: {error}: allowed are finite numbers") from error
    if not values or (count is not None and len(values) != count):
        raise UsageError(f"arm_test: {option} has {len(values)} values: allowed is {count or 'at least one'}")
    return values


def run(given: argparse.Namespace) -> int:
    """Print the figures of a posture, the tables of an arm, or draw its workspace."""
    arm = load_arm(given.arm, given.base_link, given.tip_link)
    gravity = _gravity(given.gravity)
    if given.payload is not None or given.payload_at is not None:
        arm = _loaded(arm, given)
    if given.dh:
        tables = {kind: dh_of_chain(arm.chain, kind) for kind in ("standard", "modified")}
        if given.json:
            print(json.dumps(dh_figures(arm, tables), indent=2))
        else:
            print_dh(arm, tables)
        return 0
    if given.workspace is not None:
        return _draw(arm, gravity, given)
    if given.control:
        return _compare(arm, gravity, given)
    if given.move_to is not None or given.line_to is not None:
        return _move(arm, gravity, given)
    if given.power is not None:
        raise UsageError("arm_test: --power goes with --move-to or --line-to")
    q, qd, qdd = (_joints(arm, given, name) for name in ("q", "qd", "qdd"))
    try:
        figures = figures_of(arm, q, qd, qdd, gravity, posture(arm, q, qd, qdd, gravity))
    except InvalidValueError as error:
        raise UsageError(f"arm_test: {error}") from error
    figures["payload_kg"] = 0.0 if given.payload is None else _numbers(given.payload, "--payload", 1)[0]
    if given.to is not None:
        figures["inverse_kinematics"] = _inverse(arm, given, q if given.q is not None else None)
    elif alone := [name for name in ("pointing", "prefer", "obstacle", *_TURNS) if getattr(given, name) is not None]:
        raise UsageError(f"arm_test: {_option(alone[0])} goes with --to")
    if given.json:
        print(json.dumps(figures, indent=2))
    else:
        print_figures(figures)
        if given.to is not None:
            print_inverse(figures["inverse_kinematics"])
    return 0
