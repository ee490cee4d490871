"""Files of wheel trials: comma-separated, one trial a row, in the column names of the measured data.

| quantity | columns |
|---|---|
| load [N] | load_n, vertical_load_n |
| slip ratio | slip_ratio, slip |
| slip angle | slip_angle_deg (0 without it) |
| wheel | wheel_radius_m, wheel_width_m, grouser_height_m, grouser_count, grouser_thickness_m |
| drawbar pull [N] | tractive_force_n, meas_drawbar_pull_n |
| side force [N] | lateral_force_n, meas_side_force_n |
| sinkage | sinkage_mm, meas_sinkage_m |
| torque [N m] | torque_nm, meas_torque_nm |

Lines that start with # are comments.
"""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sojourn_analysis.wheels.trials import QUANTITIES, Trials
from sojourn_analysis.wheels.wheel_bench import shape_row
from sojourn_config.command_errors import UsageError
from sojourn_machine.errors import MachineError
from sojourn_physics.contact.wheel_shape import WheelShape

LOAD = ("load_n", "vertical_load_n")
SLIP = ("slip_ratio", "slip")
SLIP_ANGLE = ("slip_angle_deg",)
MEASURED: dict[str, dict[str, float]] = {
    "drawbar_pull_n": {"tractive_force_n": 1.0, "meas_drawbar_pull_n": 1.0},
    "side_force_n": {"lateral_force_n": 1.0, "meas_side_force_n": 1.0},
    "sinkage_m": {"sinkage_mm": 1e-3, "meas_sinkage_m": 1.0},
    "torque_nm": {"torque_nm": 1.0, "meas_torque_nm": 1.0},
}
"""Columns of each measured quantity, with their unit in SI."""
WHEEL = {
    "wheel_radius_m": "radius",
    "wheel_width_m": "width",
    "grouser_height_m": "grouser_height",
    "grouser_count": "grouser_count",
    "grouser_thickness_m": "grouser_thickness",
}

Row = Mapping[str, str]


def read_rows(path: Path) -> list[dict[str, str]]:
    """Rows of a file.

    Raises:
        UsageError: it cannot be read, or holds no trial.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or error})") from error
    rows = list(csv.DictReader(line for line in lines if line.strip() and not line.startswith("#")))
    if not rows:
        raise UsageError(f"{path}: holds no trial; expected is a line of column names, then one trial a line")
    return rows


def select(rows: Sequence[dict[str, str]], conditions: Sequence[str]) -> list[dict[str, str]]:
    """Rows where every COLUMN=VALUE holds.

    Raises:
        UsageError: a condition that is none, names no column, or leaves nothing.
    """
    found = list(rows)
    for condition in conditions:
        column, separator, value = condition.partition("=")
        if not separator or column not in rows[0]:
            raise UsageError(f"--where {condition}: allowed is COLUMN=VALUE with one of the columns {_list(rows[0])}")
        found = [row for row in found if row[column] == value]
        if not found:
            raise UsageError(f"--where {condition}: no row of the file has it")
    return found


def has_wheel(rows: Sequence[Row]) -> bool:
    """Whether the file says which wheel each trial was made with."""
    return "wheel_radius_m" in rows[0] and "wheel_width_m" in rows[0]


def read_trials(path: Path, rows: Sequence[Row], wheel: WheelShape | None, gravity: float) -> Trials:
    """Trials of the rows.

    Args:
        path: for messages. wheel: of all trials; None: each row's own. gravity: at the test bed [m/s^2].

    Raises:
        UsageError: a column that is missing, or a number that is none or out of range.
    """
    if wheel is None and not has_wheel(rows):
        raise UsageError(f"{path}: has no wheel_radius_m and wheel_width_m: name the wheel with --wheel")
    load, slip = _column(path, rows, LOAD), _column(path, rows, SLIP)
    angle = _column(path, rows, SLIP_ANGLE, optional=True)
    shapes, cases, measured = [], [], []
    for number, row in enumerate(rows, start=1):
        place = f"{path}, trial {number}"
        shapes.append(shape_row(wheel or _wheel(place, row)))
        degrees = _number(place, row, angle) if angle else 0.0
        cases.append((_number(place, row, load), _number(place, row, slip), math.radians(degrees), gravity))
        measured.append([_measured(place, row, MEASURED[quantity]) for quantity in QUANTITIES])
    try:
        return Trials(np.array(shapes), np.array(cases), np.array(measured))
    except MachineError as error:
        raise UsageError(f"{path}: {error}") from error


def _column(path: Path, rows: Sequence[Row], names: Sequence[str], optional: bool = False) -> str:
    for name in names:
        if name in rows[0]:
            return name
    if optional:
        return ""
    raise UsageError(f"{path}: has no column {' or '.join(names)}; its columns are " + _list(rows[0]))


def _number(place: str, row: Row, column: str) -> float:
    try:
        value = float(row[column])
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(f"{place}: {column} = {row[column]!r}: allowed is a finite number")
    return value


def _measured(place: str, row: Row, columns: Mapping[str, float]) -> float:
    for column, unit in columns.items():
        if row.get(column):
            return unit * _number(place, row, column)
    return math.nan


def _wheel(place: str, row: Row) -> WheelShape:
    numbers = {field: _number(place, row, column) for column, field in WHEEL.items() if row.get(column)}
    try:
        return WheelShape.model_validate({"name": "from_file", "citation": place, **numbers})
    except ValueError as error:
        raise UsageError(f"{place}: the wheel {numbers} is none: {error}") from error


def _list(row: Row) -> str:
    return ", ".join(row)
