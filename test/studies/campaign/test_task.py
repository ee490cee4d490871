"""What ends a run on a worker: the run itself, or what the worker lacks."""

import errno
from pathlib import Path
from typing import Any

import pytest

from sojourn_bags.errors import UnreadableBagError, UnwritableBagError
from sojourn_bags.writer import QuickWriter
from sojourn_config.errors import ConfigError, Problem
from sojourn_machine.errors import InvalidValueError
from sojourn_studies.campaign import task
from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.row import LOST, RAISED
from sojourn_studies.campaign.task import Order

FULL = OSError(errno.ENOSPC, "No space left on device")
ORDER = Order(Draw(0, "flat_drive", {"seed": 1}, ()), "flat_drive", ("duration_limit_s=0.4", "seed=1"), True, ())


def caused(error: Exception, cause: Exception) -> Exception:
    error.__cause__ = cause
    return error


def test_a_disk_that_is_full_is_the_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: QuickWriter) -> None:
        raise FULL

    monkeypatch.setattr(QuickWriter, "flush", full)
    row = task._done(ORDER, tmp_path).row
    assert row["result"] == LOST
    assert row["reason"].endswith(" could not go on: [Errno 28] No space left on device")


@pytest.mark.parametrize(
    ("error", "result"),
    [
        (FULL, LOST),
        (MemoryError(), LOST),
        (caused(UnwritableBagError(Path("bag"), "full"), FULL), LOST),
        (UnwritableBagError(Path("bag"), "bag_0.mcap has been removed"), LOST),
        (caused(UnreadableBagError(Path("bag"), "Input/output error"), OSError(errno.EIO, "Input/output error")), LOST),
        (UnreadableBagError(Path("bag"), "it is no MCAP file"), RAISED),
        (caused(ConfigError([Problem("mine.yaml", 1, "x", "1", "2")]), FileNotFoundError("mine.yaml")), RAISED),
        (InvalidValueError("mass", -1.0, "above 0"), RAISED),
        (ZeroDivisionError("an error of ours"), RAISED),
    ],
)
def test_what_a_worker_lacks_says_nothing_of_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, result: str
) -> None:
    def fails(*_: Any) -> None:
        raise error

    monkeypatch.setattr(task, "run", fails)
    row = task._done(ORDER, tmp_path).row
    assert row["result"] == result and row["reason"]


def test_the_name_of_a_runs_own_folder_is_no_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is another each time: reasons are counted on the page."""

    def fails(*_: Any) -> None:
        raise OSError(errno.EIO, "Input/output error", str(tmp_path / "bag" / "x"))

    monkeypatch.setattr(task, "run", fails)
    assert task._done(ORDER, tmp_path).row["reason"].endswith("Input/output error: 'bag/x'")
