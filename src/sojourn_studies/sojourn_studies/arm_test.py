"""An arm on the bench: what statics, kinematics and dynamics say of a posture, and its workspace as a map.

scripts/arm_test ARM --q ...; see scripts/arm_test --help.
"""

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

from sojourn_config import command_line
from sojourn_flight.arm.secondary_task import SecondaryTask

KEYS = {
    "arm, joints, joint_kinds": "name, joint names, revolute or prismatic, in chain order",
    "q, qd, qdd": "what was asked for [rad or m, per s, per s2]",
    "gravity_m_s2": "gravity vector in the base, 3",
    "payload_kg": "mass held at the tip",
    "tip_position_m": "of the tip in the base, 3",
    "tip_quaternion_xyzw": "of the tip in the base, 4",
    "tip_rotation": "the same as a matrix, 3 x 3",
    "tip_rotation_vector_rad": "the same, axis times angle",
    "tip_roll_pitch_yaw_rad": "the same, about fixed x, y, z",
    "tip_euler_zyz_rad": "the same, about moving z, y, z",
    "orientation_singularities": "forms of the above that are not unique here, in words",
    "jacobian": "6 x n: rows vx vy vz wx wy wz of the tip in the base",
    "mass_matrix_kg_m2": "n x n, with J_m G^2 of the motors",
    "gravity_torques_n_m": "n: what holds the arm and its payload at rest",
    "coriolis_torques_n_m": "n: C(q, qd) qd, Coriolis and centrifugal",
    "friction_torques_n_m": "n: Coulomb, viscous, Stribeck",
    "inverse_dynamics_n_m": "n: M qdd + C qd + g, motors' inertia included, friction not",
    "drive_torques_n_m": "n: the same with friction",
    "manipulability": "Yoshikawa: product of the Jacobian's singular values",
    "manipulability_translation": "the same of its first three rows: of a planar arm l1 l2 |sin q2|",
    "manipulability_rotation": "the same of its last three rows",
    "smallest_singular_value": "of the Jacobian with lengths in reaches of the arm; 0: singular",
    "condition_number": "of the same; null: singular",
    "largest_payload_kg": "further mass that can be held here; null without weight",
    "collision": "links of the arm that overlap, in words; empty where none do",
    "beyond_limits, overloaded": "joints out of range, or asked for more than they can give, in words",
    "inverse_kinematics": "with --to: status (solved, singular, collision, limits, unreachable), q, errors, branches; "
    "with --prefer: secondary",
}
"""Keys of --json and what they hold."""
EARTH = 9.81
_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|-(inf|nan|infinity)", re.IGNORECASE)


def parser() -> argparse.ArgumentParser:
    """Options of scripts/arm_test."""
    result = command_line.Parser(
        prog="arm_test",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Statics, kinematics and dynamics of an arm in a posture, or its workspace.\n\n"
        "Arms: those that stand alone in urdf/, those of config/arms, and that of a rover by its name (an unknown\n"
        "name is answered with all); or the path of a URDF, or of a YAML file with a Denavit-Hartenberg table.",
        epilog="Keys of --json (SI; efforts in N for joints that slide):\n"
        + "\n".join(f"  {name:28} {words}" for name, words in KEYS.items()),
    )
    result.add_argument("arm", metavar="ARM", help="name, or path of a URDF or of a table in YAML")
    joints = "one number a joint [rad, or m where it slides] (default: zeros)"
    result.add_argument("--q", nargs="+", metavar="Q", help=f"joint positions: {joints}")
    result.add_argument("--qd", nargs="+", metavar="QD", help="joint velocities, in the same way")
    result.add_argument("--qdd", nargs="+", metavar="QDD", help="joint accelerations, in the same way")
    result.add_argument("--degrees", action="store_true", help="angles of --q, --qd, --qdd and --rpy are in degrees")
    result.add_argument(
        "--gravity",
        nargs="+",
        metavar="G",
        help=f"[m/s2] straight down (default: {EARTH:g}), or three numbers: its vector in the base",
    )
    result.add_argument("--payload", metavar="KG", help="mass held at the tip [kg]")
    result.add_argument("--payload-at", nargs="+", metavar="M", help="its centre of mass in the tip frame, x y z [m]")
    result.add_argument("--to", nargs="+", metavar="M", help="also solve for joint positions: tip at x y z [m] ...")
    result.add_argument("--rpy", nargs="+", metavar="A", help="... turned by roll, pitch, yaw about fixed x, y, z ...")
    result.add_argument("--quaternion", nargs="+", metavar="X", help="... or by a unit quaternion x y z w ...")
    result.add_argument("--rotation-vector", nargs="+", metavar="A", help="... or about an axis by its length ...")
    result.add_argument("--euler", nargs="+", metavar="A", help="... or about moving z, y, z ...")
    result.add_argument("--pointing", nargs="+", metavar="X", help="... or with the tool axis along x y z")
    result.add_argument(
        "--prefer",
        choices=get_args(SecondaryTask),
        help="with --to, what joints to spare are for: the posture that is best by this",
    )
    result.add_argument(
        "--obstacle",
        nargs="+",
        action="append",
        metavar="M",
        help="with --prefer clear: a sphere x y z radius in the base [m]; again for more",
    )
    result.add_argument("--base-link", metavar="LINK", help="of a URDF: where the arm begins (default: outermost link)")
    result.add_argument("--tip-link", metavar="LINK", help="of a URDF: its tip (default: end of the longest line)")
    result.add_argument("--dh", action="store_true", help="print the Denavit-Hartenberg tables instead")
    result.add_argument(
        "--workspace",
        nargs="?",
        type=Path,
        const=Path("workspace.png"),
        metavar="FILE",
        help="draw the workspace into a picture (default: %(const)s) instead",
    )
    result.add_argument(
        "--control", action="store_true", help="compare control laws on one motion instead, in a simulated loop"
    )
    result.add_argument("--move-to", nargs="+", metavar="Q", help="compare motions from --q to these positions instead")
    result.add_argument("--line-to", nargs="+", metavar="M", help="move the tip from --q straight to x y z [m] instead")
    result.add_argument("--power", metavar="W", help="with these two: also time-optimal under this power [W]")
    result.add_argument(
        "--mass-error",
        default="0.2",
        metavar="SHARE",
        help="with --control: how much too heavy the laws take the links in the second round (default: %(default)s)",
    )
    result.add_argument("--json", action="store_true", help="print JSON")
    return result


def _protected(arguments: Sequence[str]) -> list[str]:
    """Arguments with a blank before every negative number and list of them, or argparse takes -1e-3 for an option."""
    return [f" {word}" if _NUMBER.fullmatch(word.split(",")[0]) else word for word in arguments]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures of a posture, the tables of an arm, or draw its workspace."""
    given = parser().parse_args(_protected(sys.argv[1:] if arguments is None else arguments))
    from sojourn_studies.arm_answers import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
