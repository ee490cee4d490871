"""Whole campaigns on workers of this machine: the same table however many there are, and after a kill."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest
from pyarrow import parquet

from sojourn_config.command_errors import UsageError
from sojourn_studies.campaign import cluster, command, conduct
from sojourn_studies.campaign.errors import CampaignError
from sojourn_studies.campaign.folder import WORK
from sojourn_studies.campaign.identity import IDENTITY, JOURNAL, LOCK
from sojourn_studies.campaign.row import LOST, MET, unfinished_row
from sojourn_studies.campaign.table import TABLE
from sojourn_studies.campaign.task import Finished, Order

CAMPAIGN = """
description: Short drives, of which one cannot be
scenario: {scenario}
set: {{duration_limit_s: 0.4, seed: 1}}
values:
  start.x: {{kind: grid, of: [-1.0, 8.0]}}
  terrain.size_x: {{kind: grid, of: [20.0, 10.0]}}
keep: {{failures: false, sample: 0.3}}
"""


@pytest.fixture
def campaign(tmp_path: Path) -> str:
    """Its scenario is a file of the user's, which workers do not have."""
    own = tmp_path / "own"
    own.mkdir()
    (own / "mine.yaml").write_text("extends: flat_drive\nseed: 7\n", encoding="utf-8")
    file = own / "short.yaml"
    file.write_text(CAMPAIGN.format(scenario=own / "mine.yaml"), encoding="utf-8")
    return str(file)


@contextmanager
def owners_mask() -> Iterator[None]:
    """A campaign sets the mask of its process, which here is that of all tests."""
    before = os.umask(0o022)
    try:
        yield
    finally:
        os.umask(before)


def run(campaign: str, out: Path, *options: str) -> int:
    with owners_mask():
        return command.main([campaign, "--out", str(out), *options])


def test_the_table_is_the_same_after_a_kill_and_with_other_workers(campaign: str, tmp_path: Path) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    assert run(campaign, whole, "--workers", "1") == 0
    program = [
        sys.executable,
        "-m",
        "sojourn_studies.campaign.command",
        campaign,
        "--out",
        str(killed),
        "--workers",
        "2",
    ]
    process = subprocess.Popen(program, start_new_session=True, stdout=subprocess.DEVNULL)
    while _lines(killed / JOURNAL) < 1:
        assert process.poll() is None, "it ended before a run was done"
        time.sleep(0.02)
    process.kill()
    process.wait()
    assert _lines(killed / JOURNAL) <= 4
    _wait_for_the_end_of(process.pid)
    assert run(campaign, killed, "--workers", "1") == 0
    assert (killed / TABLE).read_bytes() == (whole / TABLE).read_bytes()
    assert len((killed / JOURNAL).read_bytes().splitlines()) == 4, "no run was done twice"

    rows = parquet.read_table(whole / TABLE).to_pylist()
    assert [row["run"] for row in rows] == [0, 1, 2, 3]
    assert [row["result"] for row in rows] == ["not met", "not met", "not met", "raised"]
    assert "off the terrain" in rows[3]["reason"] and rows[3]["goal_error_m"] is None
    assert rows[2]["goal_error_m"] == pytest.approx(7.0, abs=0.01)
    kept = [row["run"] for row in rows if row["kept"]]
    assert kept == [int(folder.name) for folder in sorted((whole / "runs").iterdir())] != []
    page = (whole / "report.html").read_text(encoding="utf-8")
    for number in kept:
        assert f'href="runs/{number:05d}/report.html"' in page
        assert (whole / "runs" / f"{number:05d}" / "bag" / "metadata.yaml").is_file()
    assert not (whole / WORK).exists()
    for path in (whole, *whole.rglob("*")):
        assert path.stat().st_mode & 0o077 == 0, f"{path} is not its owner's alone"


def _lines(journal: Path) -> int:
    """Whole lines of a file that another process may just have made."""
    return journal.read_bytes().count(b"\n") if journal.is_file() else 0


def _wait_for_the_end_of(session: int) -> None:
    """Workers whose campaign was killed end by themselves."""
    until = time.monotonic() + 300.0
    while time.monotonic() < until:
        try:
            os.killpg(session, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.killpg(session, signal.SIGKILL)
    raise AssertionError("workers live on without their campaign")


def test_a_scheduler_that_does_not_answer_is_named(
    campaign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "CONNECT_S", 0.3)
    with pytest.raises(UsageError, match="--scheduler foo: it cannot be reached"):
        run(campaign, tmp_path / "out", "--scheduler", "foo")
    with pytest.raises(UsageError, match=r"--scheduler tcp://127\.0\.0\.1:9: it cannot be reached"):
        run(campaign, tmp_path / "out", "--scheduler", "tcp://127.0.0.1:9")
    with pytest.raises(UsageError, match="it cannot be reached"):
        run(campaign, tmp_path / "out", "--scheduler", "carrier-pigeon://x")
    assert not (tmp_path / "out").exists(), "nothing has started"


def test_no_table_and_no_page_are_written_of_no_runs(
    campaign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(conduct, "carry_out", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(campaign, tmp_path / "out", "--workers", "1")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {IDENTITY, LOCK}


class NoClient:
    """Of no worker."""

    def nthreads(self) -> dict[str, int]:
        return {}


def test_lost_runs_are_not_judged_and_come_last(
    campaign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    asked: list[list[int]] = []

    def disk_is_full(_: object, orders: list[Order], __: object, take: Callable[[Finished], None]) -> None:
        asked.append([order.draw.number for order in orders])
        for order in orders[:2] if len(asked) == 1 else orders:
            take(Finished(unfinished_row(order.draw, LOST, "No space left on device")))

    monkeypatch.setattr(conduct, "workers_here", lambda *_: nullcontext(NoClient()))
    monkeypatch.setattr(conduct, "carry_out", disk_is_full)
    assert run(campaign, out) == 1
    assert run(campaign, out) == 1
    assert asked == [[0, 1, 2, 3], [2, 3, 0, 1]]
    assert "4 runs were lost and are not judged (No space left on device): the same command" in capsys.readouterr().out
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "0 OF 4 RUNS ARE DONE" in page and "0 of 0 runs met their goals: no run" in page
    assert [row["result"] for row in parquet.read_table(out / TABLE).to_pylist()] == [LOST] * 4


def test_a_folder_that_is_moved_away_ends_in_a_sentence(
    campaign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"

    def moved(_: object, orders: list[Order], __: object, take: Callable[[Finished], None]) -> None:
        take(Finished(unfinished_row(orders[0].draw, LOST, "x")))
        out.rename(tmp_path / "elsewhere")
        take(Finished(unfinished_row(orders[1].draw, LOST, "x")))

    monkeypatch.setattr(conduct, "workers_here", lambda *_: nullcontext(NoClient()))
    monkeypatch.setattr(conduct, "carry_out", moved)
    with pytest.raises(CampaignError, match="was moved or removed"):
        run(campaign, out)
    assert not out.exists()


def test_more_runs_go_on_where_they_bring_a_further_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out, file = tmp_path / "out", tmp_path / "mine.yaml"
    monkeypatch.setattr(conduct, "workers_here", lambda *_: nullcontext(NoClient()))
    monkeypatch.setattr(conduct, "carry_out", lambda _, orders, __, take: take(finished_at_once(orders[0])))
    for runs in (1, 2, 1):
        file.write_text(
            f"description: x\nscenario: flat_drive\nruns: {runs}\n"
            "values: {machine: {kind: list, of: [explorer, skid]}}\n",
            encoding="utf-8",
        )
        assert run(str(file), out) == 0
    with (out / JOURNAL).open("r+b") as journal:
        journal.write(b"\0" * 9)
    assert run(str(file), out) == 0
    assert f"{out / JOURNAL}, line 1: it is no row of a run and is passed over" in capsys.readouterr().out
    assert _lines(out / JOURNAL) == 3


def finished_at_once(order: Order) -> Finished:
    """With the row of a run that met its goals."""
    return Finished(unfinished_row(order.draw, MET, ""))
