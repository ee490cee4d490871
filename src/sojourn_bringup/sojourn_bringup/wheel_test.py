"""Single-wheel test bed in the terminal: scripts/wheel_test."""

import argparse
import json
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sojourn_bringup import options
from sojourn_bringup.errors import UsageError
from sojourn_bringup.trial_file import WHEEL, read_rows, read_trials, select
from sojourn_config.load import load_params, validate
from sojourn_config.overrides import override_document, split_override
from sojourn_config.yaml_file import Data, YamlDocument
from sojourn_mechanics.contact.trials import QUANTITIES, predict, summary
from sojourn_mechanics.contact.wheel_bench import GRAVITY, BenchResult, measure
from sojourn_mechanics.contact.wheel_shape import WheelShape
from sojourn_mechanics.errors import MechanicsError
from sojourn_mechanics.soil.params import SoilParams, kernel_row

DEFAULT_WHEEL = "explorer"
DEFAULT_SOIL = "lunar_nominal"
DEFAULT_PLOT = "wheel_test.png"
TABLE_WIDTH = 120
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

columns of a --csv file: load_n or vertical_load_n; slip_ratio or slip; slip_angle_deg; wheel_radius_m, wheel_width_m,
  grouser_height_m, grouser_count (which count where --wheel is not given); measured: tractive_force_n or
  meas_drawbar_pull_n, lateral_force_n or meas_side_force_n, sinkage_mm or meas_sinkage_m, torque_nm or meas_torque_nm
"""


def number_list(text: str) -> list[float]:
    """Numbers with commas between them."""
    return [options.number(part) for part in text.split(",")]


def parser() -> argparse.ArgumentParser:
    """Options of scripts/wheel_test."""
    result = options.Parser(
        prog="wheel_test",
        description="Test a rigid wheel on soil: sinkage, drawbar pull, side force and torque in steady motion.",
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
    result.add_argument("--load", type=options.number, metavar="N", help="load on the wheel [N]")
    result.add_argument("--slip", type=number_list, metavar="S[,S...]", help="slip ratios, -1 to 1 (default: 0.2)")
    result.add_argument(
        "--slip-angle", type=number_list, metavar="DEG[,DEG...]", help="slip angles, -90 to 90 (default: 0)"
    )
    result.add_argument(
        "--gravity", type=options.number, default=GRAVITY, metavar="G",
        help="where the test bed is [m/s2]: weight of the soil that is pushed (default: %(default)s)",
    )  # fmt: skip
    result.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="change a parameter; repeatable"
    )
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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the test bed; 0 if every case was carried."""
    given = parser().parse_args(_minus_values(arguments))
    try:
        return _run(given)
    except MechanicsError as error:
        raise UsageError(str(error)) from error


def _run(given: argparse.Namespace) -> int:
    changes = _changes(given.set)
    if not given.gravity >= 0.0:
        raise UsageError(f"--gravity {given.gravity:g}: allowed is a number of at least 0")
    soil = load_params("soils", given.soil, SoilParams, changes["soil"])
    if given.csv is not None:
        return _trials(given, soil, changes["wheel"])
    if given.where:
        raise UsageError("--where goes with --csv")
    if given.load is None:
        raise UsageError("--load is missing: the load on the wheel [N] (see wheel_test --help)")
    wheel = _wheel(given.wheel, changes["wheel"])
    slips, angles = given.slip or [0.2], given.slip_angle or [0.0]
    results = measure(wheel, soil, given.load, slips, angles, given.gravity)
    if given.json:
        print(json.dumps([{"wheel": wheel.name, "soil": soil.name, **asdict(result)} for result in results], indent=1))
    else:
        _print_results(wheel, soil, results)
    if given.plot is not None:
        # matplotlib takes a second to load, for nothing where there is no plot
        from sojourn_bringup.wheel_plot import draw

        draw(given.plot, wheel, soil, given.load, angles, given.gravity, results)
        if not given.json:
            print(f"plot: {given.plot}")
    return 0


def _trials(given: argparse.Namespace, soil: SoilParams, wheel_changes: list[str]) -> int:
    refused = ("load", "slip", "slip_angle", "plot")
    for option in refused:
        if getattr(given, option) is not None:
            raise UsageError(f"--{option.replace('_', '-')} does not go with --csv: the file says it")
    rows = select(read_rows(given.csv), given.where)
    wheel = None
    if given.wheel is not None:
        wheel = _wheel(given.wheel, wheel_changes)
    elif wheel_changes:
        # what --set leaves open each row may say, such as its grousers
        rows = [{**row, **_as_columns(wheel_changes)} for row in rows]
    trials = read_trials(given.csv, rows, wheel, given.gravity)
    predicted = predict(trials, kernel_row(soil))
    statistics = summary(trials, predicted)
    if given.json:
        named = [
            {**row, **dict(zip(QUANTITIES, [_or_none(x) for x in values], strict=True))}
            for row, values in zip(rows, predicted.tolist(), strict=True)
        ]
        finite = {key: {name: _or_none(x) for name, x in part.items()} for key, part in statistics.items()}
        print(json.dumps({"rows": named, "statistics": {"soil": soil.name, **finite}}, indent=1))
    else:
        print_statistics(f"{given.csv.name} on {soil.name}", statistics)
    return 0


def _wheel(name: str | None, changes: list[str]) -> WheelShape:
    """The wheel with its changes. Radius and width without a name are a smooth wheel of that size."""
    given = {text.partition("=")[0] for text in changes}
    if name is None and {"radius", "width"} <= given:
        blank: dict[str, Data] = {"name": "custom", "citation": "command line"}
        return validate(override_document(YamlDocument("command line", blank, {}), changes), WheelShape)
    return load_params("wheels", name or DEFAULT_WHEEL, WheelShape, changes)


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


def _changes(texts: Sequence[str]) -> dict[str, list[str]]:
    """--set texts for the wheel and for the soil, without their first word."""
    sorted_texts: dict[str, list[str]] = {"wheel": [], "soil": []}
    for text in texts:
        path, value = split_override(text)
        if len(path) < 2 or path[0] not in sorted_texts:
            raise UsageError(f"--set {text}: unknown key {path[0]}; allowed is wheel.KEY=VALUE or soil.KEY=VALUE")
        sorted_texts[str(path[0])].append(".".join(str(part) for part in path[1:]) + "=" + value)
    return sorted_texts


def _as_columns(wheel_changes: Sequence[str]) -> dict[str, str]:
    columns = {field: column for column, field in WHEEL.items()}
    found = {}
    for text in wheel_changes:
        field, _, value = text.partition("=")
        if field not in columns:
            raise UsageError(f"--set wheel.{text}: with the wheels of a --csv allowed are " + ", ".join(columns))
        found[columns[field]] = value
    return found


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _print_results(wheel: WheelShape, soil: SoilParams, results: Sequence[BenchResult]) -> None:
    grousers = f", {wheel.grouser_count} grousers of {1e3 * wheel.grouser_height:g} mm" if wheel.grouser_count else ""
    print(f"wheel {wheel.name}: radius {wheel.radius:g} m, width {wheel.width:g} m{grousers}")
    print(f"soil {soil.name}; load {results[0].load_n:g} N\n")
    heads = (
        ("slip", "[-]"), ("slip angle", "[deg]"), ("sinkage", "[mm]"), ("drawbar pull", "[N]"), ("side force", "[N]"),
        ("torque", "[N m]"), ("entry", "[deg]"), ("exit", "[deg]"), ("compaction", "[N]"), ("bulldozing", "[N]"),
    )  # fmt: skip
    table = Table(box=None, pad_edge=False)
    for name, unit in heads:
        table.add_column(f"{name}\n{escape(unit)}", justify="right")
    for one in results:
        table.add_row(
            f"{one.slip:g}", f"{one.slip_angle_deg:g}", f"{1e3 * one.sinkage_m:.2f}", f"{one.drawbar_pull_n:.2f}",
            f"{one.side_force_n:.2f}", f"{one.torque_nm:.3f}", f"{math.degrees(one.entry_angle_rad):.1f}",
            f"{math.degrees(one.exit_angle_rad):.1f}", f"{one.resistances['compaction_n']:.2f}",
            f"{one.resistances['bulldozing_n']:.2f}",
        )  # fmt: skip
    print_table(table)


def print_table(table: Table) -> None:
    """Print a table in its full width, in a narrow terminal and in a file as well."""
    console = Console()
    console.width = max(console.width, TABLE_WIDTH)
    console.print(table)


def print_statistics(title: str, statistics: Mapping[str, Mapping[str, float | int | None]]) -> None:
    """Print the errors of predictions as a table."""
    print(f"{title}: median error, over the load for forces, over the radius for sinkage, over both for torque\n")
    table = Table(box=None, pad_edge=False)
    for name in ("", "trials", "drawbar pull [%]", "side force [%]", "sinkage [%]", "torque [%]", "not carried"):
        table.add_column(escape(name), justify="left" if not name else "right")
    names = {"driving": "driving (slip >= 0, angle <= 45)"}
    for key, part in statistics.items():
        table.add_row(
            names.get(key, key),
            str(part["trials"]),
            *(_percent(part[f"{q.rsplit('_', 1)[0]}_error_percent"]) for q in QUANTITIES),
            str(part["not_carried"]),
        )
    print_table(table)


def _percent(value: float | int | None) -> str:
    return "-" if value is None else f"{value:.2f}"


if __name__ == "__main__":
    options.run_script(main)
