"""scripts/report, plot and recover: exit status, words, and where the files go."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sojourn_bags import compare_command as compare
from sojourn_bags import plot_command as plot
from sojourn_bags import recover_command as recover
from sojourn_bags import report_command as report
from sojourn_config.command_errors import UsageError

sys.path.insert(0, str(Path(__file__).parents[1] / "bags"))
from test_run_summary import make_run

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a made-up run."""
    folder = tmp_path_factory.mktemp("command")
    make_run(folder / "bag")
    return folder


def test_report_writes_beside_the_bag(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert report.main([str(run)]) == 0
    words = capsys.readouterr().out
    assert words.startswith("Every goal was met") and "arm: unfold: reached" in words
    assert (run / "report.png").stat().st_size > 100_000
    assert json.loads((run / "summary.json").read_text())["all_met"] is True
    assert report.main([str(run), "--html", "--no-contract"]) == 0
    assert (run / "report.html").read_text().startswith("<!DOCTYPE html>")


@pytest.mark.parametrize(("options", "name"), [([], "report.png"), (["--html", "--no-contract"], "report.html")])
def test_a_report_goes_into_a_folder_that_is_named(run: Path, tmp_path: Path, options: list[str], name: str) -> None:
    """It went beside the folder, under its name."""
    assert report.main([str(run), "--out", str(tmp_path), *options]) == 0
    assert (tmp_path / name).stat().st_size > 10_000
    assert not [path for path in tmp_path.parent.iterdir() if path.name.startswith(f"{tmp_path.name}.")]


@pytest.fixture
def open_to_all() -> Iterator[None]:
    """What is written can be read by everybody, unless somebody sees to it."""
    before = os.umask(0o022)
    yield
    assert os.umask(before) == 0o022  # what else is written is as it was


def modes(folder: Path) -> set[int]:
    """Of all that is in a folder."""
    return {path.stat().st_mode & 0o777 for path in folder.rglob("*")}


@pytest.mark.parametrize("options", [[], ["--html", "--no-contract"]])
def test_a_report_is_its_owners_alone_as_its_bag_is(
    run: Path, tmp_path: Path, options: list[str], open_to_all: None
) -> None:
    assert report.main([str(run), "--out", str(tmp_path), *options]) == 0
    assert modes(tmp_path) == {0o600}


def test_so_are_a_plot_and_its_numbers(run: Path, tmp_path: Path, open_to_all: None) -> None:
    arguments = [str(run), "/truth/electrical.percentage", "--out", str(tmp_path / "a.png")]
    assert plot.main([*arguments, "--csv", str(tmp_path / "a.csv")]) == 0
    assert modes(tmp_path) == {0o600}


def test_so_are_a_mended_bag_and_the_result_of_a_comparison(run: Path, tmp_path: Path, open_to_all: None) -> None:
    cut, out = tmp_path / "cut.mcap", tmp_path / "out"
    data = (run / "bag" / "bag_0.mcap").read_bytes()
    cut.write_bytes(data[: len(data) // 2])
    out.mkdir()
    assert recover.main([str(cut), "--out", str(out / "mended")]) == 0
    assert compare.main([str(run), str(run), "--json", str(out / "same.json"), "--bag", str(out / "both")]) == 0
    assert modes(out) == {0o600, 0o700}


def test_plot_prints_the_numbers(run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    field = "/truth/electrical.percentage"
    arguments = [str(run), field, field, "--out", str(tmp_path / "a.png"), "--csv", str(tmp_path / "a.csv")]
    assert plot.main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["0.79", "0.794975", "0.79995", "200", field]
    assert (tmp_path / "a.png").exists() and len((tmp_path / "a.csv").read_text().splitlines()) == 201


def test_recover_whole_cut_and_again(run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert recover.main([str(run)]) == 0
    assert "nothing to mend" in capsys.readouterr().out
    cut = tmp_path / "cut.mcap"
    data = (run / "bag" / "bag_0.mcap").read_bytes()
    cut.write_bytes(data[: len(data) // 2])
    assert recover.main([str(cut)]) == 0
    words = capsys.readouterr().out
    assert "messages recovered, up to" in words and "cannot be known: the bag has no /diagnostics" in words
    assert (tmp_path / "cut_recovered" / "metadata.yaml").exists() and cut.read_bytes() == data[: len(data) // 2]
    with pytest.raises(UsageError, match="there is a bag in"):
        recover.main([str(cut)])


@pytest.mark.parametrize(
    ("command", "arguments"),
    [("report", []), ("report", ["--html"]), ("plot", ["/odom.pose"]), ("recover", [])],
)
def test_no_bag_is_one_sentence_and_status_2(command: str, arguments: list[str], tmp_path: Path) -> None:
    text = tmp_path / "notes.mcap"
    text.write_text("no bag at all")
    line = [sys.executable, "-m", f"sojourn_bags.{command}_command", str(text), *arguments]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, env=os.environ, check=False)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "it is no MCAP file" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["notes.mcap"]


@pytest.mark.parametrize(("command", "arguments"), [(report, []), (plot, ["/truth/odom.pose.pose.position.x"])])
def test_of_a_bag_that_is_cut_off_what_there_is_is_shown_and_the_status_is_1(
    command: Any, arguments: list[str], run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut, picture = tmp_path / "cut.mcap", tmp_path / "picture.png"
    (whole,) = run.rglob("*.mcap")
    data = whole.read_bytes()
    cut.write_bytes(data[: len(data) - 40])
    assert command.main([str(cut), *arguments, "--out", str(picture)]) == 1
    assert picture.stat().st_size > 1000
    assert capsys.readouterr().err.splitlines() == [
        f"{cut} is cut off, so this holds as far as it goes (scripts/recover mends it)"
    ]


@pytest.mark.parametrize("name", ["report", "plot", "recover"])
def test_script_starts_its_module(name: str) -> None:
    script = ROOT / "scripts" / name
    assert os.access(script, os.X_OK) and f"-m sojourn_bags.{name}_command " in script.read_text()
