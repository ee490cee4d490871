"""The table of a campaign: what its columns hold."""

from pathlib import Path
from typing import Any

import pytest
from pyarrow import parquet

from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.row import MET, unfinished_row
from sojourn_studies.campaign.table import schema, write_table


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ([1, 2**63 - 1, -(2**63)], "int64"),
        ([1, 10**20], "double"),
        ([1, -(10**20), None], "double"),
        ([True, False], "bool"),
        ([True, 1], "string"),
    ],
)
def test_a_column_holds_whatever_its_key_is_given(tmp_path: Path, values: list[Any], kind: str) -> None:
    """A whole number of more than 64 bits lost the table after all runs were done."""
    runs = [Draw(number, "flat_drive", {"key": value}, ()) for number, value in enumerate(values)]
    write_table(tmp_path / "t.parquet", [unfinished_row(run, MET, "") for run in runs], schema(runs))
    column = parquet.read_table(tmp_path / "t.parquet").column("key")
    assert str(column.type) == kind
    assert column.to_pylist() == ([str(value) for value in values] if kind == "string" else values)
