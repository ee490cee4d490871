"""Single-wheel test bed in the terminal: scripts/wheel_test."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from sojourn_analysis.wheels.test_bed import GRAVITY
from sojourn_config import command_line
from sojourn_machine.contact_choice import CONTACT_LAWS, DEFAULT_CONTACT

DEFAULT_WHEEL = "explorer"
DEFAULT_SOIL = "lunar_nominal"
DEFAULT_PLOT = "wheel_test.png"
DEFAULT_LAW = str(DEFAULT_CONTACT["model"])
CONVENTIONS = """
signs and definitions:
  slip ratio     (rim speed - travel speed) / the larger of the two: -1 locked, 0 free rolling, 1 spinning on the spot;
                 the travel speed is that of the carriage, in the direction of travel
  slip angle     from the wheel's heading to the direction of travel, positive to the left, -90 to 90 degrees
  drawbar pull   force on the wheel along its heading: positive pulls the vehicle
  side force     force on the wheel to its left: negative for a positive slip angle, against the motion
  torque         that the motor has to supply: positive drives
  sinkage        of the lowest point of the rim below the undisturbed surface

parameters for --set (of config/wheels and config/soils), for example:
  wheel.radius wheel.width wheel.grouser_height wheel.grouser_count soil.n soil.k_c soil.k_phi soil.cohesion
  soil.friction_angle_deg soil.shear_modulus soil.theta_m_c1 soil.theta_m_c2
  soil.exit_angle   zero, or lambda:L with L the height of the rut behind the wheel over the sinkage
  soil.form         bekker: p = (k_c/b + k_phi) z^n; reece: p = (k_c + b k_phi)(z/b)^n
  law.KEY           a parameter of the contact law that --law names, as in the table `contact` of a machine's wheel

columns of a --csv file: load_n or vertical_load_n; slip_ratio or slip; slip_angle_deg; wheel_radius_m, wheel_width_m,
  grouser_height_m, grouser_count (which count where --wheel is not given); measured: tractive_force_n or
  meas_drawbar_pull_n, lateral_force_n or meas_side_force_n, sinkage_mm or meas_sinkage_m, torque_nm or meas_torque_nm
"""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/wheel_test."""
    result = command_line.Parser(
        prog="wheel_test",
        description="Test a wheel on its ground: sinkage, drawbar pull, side force and torque in steady motion.",
        epilog=CONVENTIONS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    result.add_argument(
        "--wheel",
        metavar="NAME|FILE",
        help=f"of config/wheels, or a file (default: that of the --csv; a smooth one, where --set gives "
        f"wheel.radius and wheel.width; {DEFAULT_WHEEL})",
    )
    result.add_argument(
        "--soil", default=DEFAULT_SOIL, metavar="NAME|FILE", help="of config/soils, or a file (default: %(default)s)"
    )
    result.add_argument(
        "--law", metavar="NAME",
        help="contact law of the wheel: " + ", ".join(CONTACT_LAWS.names()) + f" (default: {DEFAULT_LAW})",
    )  # fmt: skip
    result.add_argument(
        "--machine", metavar="NAME", help="take the first wheel of a machine, and its law, in place of --wheel, --law"
    )
    result.add_argument("--load", type=command_line.number, metavar="N", help="load on the wheel [N]")
    result.add_argument(
        "--slip", type=command_line.number_list, metavar="S[,S...]", help="slip ratios, -1 to 1 (default: 0.2)"
    )
    result.add_argument(
        "--slip-angle",
        type=command_line.number_list,
        metavar="DEG[,DEG...]",
        help="slip angles, -90 to 90 (default: 0)",
    )
    result.add_argument(
        "--gravity", type=command_line.number, default=GRAVITY, metavar="G",
        help="where the test bed is [m/s2]: weight of the soil that is pushed (default: %(default)s)",
    )  # fmt: skip
    command_line.add_changes(result, "change a parameter")
    result.add_argument("--csv", type=Path, metavar="FILE", help="predict every trial of a file, and tell the errors")
    result.add_argument(
        "--where", action="append", default=[], metavar="COLUMN=VALUE", help="of --csv take these rows; repeatable"
    )
    result.add_argument("--json", action="store_true", help="print JSON")
    result.add_argument(
        "--plot", type=Path, nargs="?", const=Path(DEFAULT_PLOT), metavar="FILE",
        help=f"draw the curves over the slip, with the spread of the soil's parameters (default: {DEFAULT_PLOT})",
    )  # fmt: skip
    return result


def _minus_values(arguments: Sequence[str] | None) -> list[str] | None:
    """Join `--slip -0.2,0.1`, which argparse takes for an option that it does not know."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    joined: list[str] = []
    for text in given:
        if joined and joined[-1] in ("--slip", "--slip-angle", "--load", "--gravity") and text[:1] == "-":
            joined[-1] += "=" + text
        else:
            joined.append(text)
    return joined


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the test bed; 0 if every case was carried."""
    given = parser().parse_args(_minus_values(arguments))
    from sojourn_studies.wheel_bed import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
