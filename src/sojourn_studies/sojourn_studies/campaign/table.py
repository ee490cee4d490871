"""The rows of a campaign as Parquet: one file that any tool of the field reads, the same for the same campaign."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.row import FIGURES, FIXED, plain

TABLE, COSTS = "table.parquet", "costs.parquet"
_TYPES = {
    "run": pa.int64(),
    "seed": pa.int64(),
    "goals": pa.int64(),
    "goals_met": pa.int64(),
    "rolled_over": pa.bool_(),
    "kept": pa.bool_(),
    **dict.fromkeys(("scenario", "result", "reason"), pa.string()),
    **dict.fromkeys(FIGURES, pa.float64()),
}
_COST_TYPES = {
    "run": pa.int64(),
    "cpu_s": pa.float64(),
    "run_s": pa.float64(),
    "wall_s": pa.float64(),
    "worker": pa.string(),
}


def varied_keys(runs: Sequence[Draw]) -> list[str]:
    """Keys that vary and have a column of their own."""
    return [key for key in runs[0].values if key not in FIXED]


def schema(runs: Sequence[Draw]) -> pa.Schema:
    """Columns of a campaign's table: they follow from its draws, whatever has been run of them."""
    varied = {key: _type_of([plain(one.values[key]) for one in runs]) for key in varied_keys(runs)}
    order = ["run", "scenario", "seed", *varied, *(name for name in FIXED if name not in ("run", "scenario", "seed"))]
    return pa.schema([(name, {**_TYPES, **varied}[name]) for name in order])


def write_table(path: Path, rows: Iterable[Mapping[str, Any]], columns: pa.Schema) -> None:
    """Write rows by the numbers of their runs; the file is swapped in whole."""
    ordered = sorted(rows, key=lambda row: row["run"])
    data = {
        column.name: pa.array([_cell(row.get(column.name), column.type) for row in ordered], column.type)
        for column in columns
    }
    fresh = path.with_suffix(".fresh")
    parquet.write_table(pa.table(data, schema=columns), fresh, compression="zstd")
    fresh.rename(path)


def write_costs(path: Path, costs: Mapping[int, Mapping[str, Any]]) -> None:
    """What each run took, beside the table: it is never twice the same."""
    write_table(path, [{"run": number, **cost} for number, cost in costs.items()], pa.schema(list(_COST_TYPES.items())))


def _type_of(values: Sequence[Any]) -> pa.DataType:
    kinds = {_kind_of(value) for value in values if value is not None}
    if kinds <= {bool}:
        return pa.bool_()
    if kinds <= {int}:
        return pa.int64()
    return pa.float64() if kinds <= {int, float} else pa.string()


def _kind_of(value: Any) -> type:
    """Its type; a whole number that has no room in 64 bits counts as a floating-point number."""
    return float if type(value) is int and not -(2**63) <= value < 2**63 else type(value)


def _cell(value: Any, kind: pa.DataType) -> Any:
    if value is None:
        return None
    if kind == pa.string():
        return str(value)
    return float(value) if kind == pa.float64() else value
