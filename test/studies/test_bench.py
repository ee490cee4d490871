"""The bench: where its figures go, what it says meanwhile, and the yardstick that it tells speeds in."""

import json
from pathlib import Path

import pytest

from sojourn_config.command_errors import CommandError, UsageError
from sojourn_studies import bench, bench_parts
from sojourn_studies.bench_step import YARDSTICK


def test_figures_go_into_a_new_file_with_a_yardstick_of_the_same_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "figures.json"
    assert bench.main(["--only", "step", "--json", str(file)]) == 0
    figures = json.loads(file.read_text(encoding="utf-8"))
    unit = figures["Y = aba + forwardKinematics + computeJointJacobians [us]"]
    assert unit == pytest.approx(sum(figures[f"  {name} [us]"] for name in YARDSTICK))
    assert figures["plant step [Y]"] == pytest.approx(figures["plant step [us]"] / unit)
    printed = capsys.readouterr()
    assert "step, part 1 of 1 ..." in printed.err and "step took " in printed.err
    assert "plant step [Y]" in printed.out
    with pytest.raises(UsageError, match="is there already"):
        bench.main(["--only", "step", "--json", str(file)])


def test_a_machine_without_wheels_has_its_figures_too_and_no_bars_of_anothers(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file, parts = tmp_path / "figures.json", ("--only", "step", "--only", "period")
    assert bench.main(["--scenario", "tracked_course", *parts, "--seconds", "1", "--json", str(file)]) == 0
    figures = json.loads(file.read_text(encoding="utf-8"))
    assert figures["contact kernel for each wheel or track [us]"] > 0.0
    assert figures["app of drive [us]"] > 0.0 and "app of arm [us]" not in figures
    assert "<=" not in capfd.readouterr().out
    with pytest.raises(UsageError, match="commands, which has its own scene; allowed: step, period"):
        bench.main(["--scenario", "tracked_course", "--only", "commands"])


def test_without_a_file_named_they_go_into_a_folder_of_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_parts, "repository_root", lambda: tmp_path)
    first, second = bench_parts.place_of(None), bench_parts.place_of(None)
    assert first.parent.parent == second.parent.parent == tmp_path / "runs" and first.parent != second.parent
    assert not (tmp_path / "runs" / "latest").exists(), "that is the newest run, and this is none"


def test_a_file_without_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no folder"):
        bench_parts.place_of(tmp_path / "nowhere" / "figures.json")


def test_the_loop_is_told_in_the_yardstick_of_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the machine does meanwhile: at 5 times real time a period takes 4000 us, 400 times a Y of 10 us."""
    units, lines = iter([8.0, 12.0, 20.0, 20.0, 9.0, 11.0]), []

    class Clock:
        def microseconds(self) -> float:
            return next(units)

    monkeypatch.setattr(bench_parts.bench_loop, "Yardstick", Clock)
    speeds = iter([5.0, 2.0, 5.0])
    monkeypatch.setattr(
        bench_parts.bench_loop, "run_loop", lambda kind, scenario, seconds: {f"{kind}, times real time": next(speeds)}
    )
    figures = bench_parts.bench_loop.bench_loop("composed", "any", 1.0, 3, lines.append)
    assert figures["composed, period of the loop [Y]"] == pytest.approx(400.0)
    assert figures["composed, times real time"] == 5.0 and len(lines) == 3


def test_every_part_has_its_name_among_the_options() -> None:
    assert tuple(bench_parts.PARTS) == bench.PART_NAMES


def test_all_parts_are_shorter_without_full() -> None:
    for name, quick in bench_parts.QUICK._asdict().items():
        assert quick < bench_parts.FULL._asdict()[name], name


def test_a_part_that_cannot_be_measured_is_told_of_and_the_others_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def cannot(*_given: object) -> dict[str, float]:
        raise CommandError("the machine is too busy")

    monkeypatch.setitem(bench_parts.PARTS, "commands", cannot)
    monkeypatch.setitem(bench_parts.PARTS, "ground", lambda *_given: {"a figure": 7.0})
    file = tmp_path / "figures.json"
    assert bench.main(["--only", "commands", "--only", "ground", "--json", str(file)]) == 1
    assert json.loads(file.read_text(encoding="utf-8")) == {"a figure": 7.0}
    printed = capsys.readouterr()
    assert "commands could not be measured: the machine is too busy" in printed.err and "a figure" in printed.out
