"""A run without middleware: it meets nobody, so that others may have its domain; it is judged as any run."""

from pathlib import Path

import pytest

from sojourn_bags.reading import read_bag
from sojourn_bringup import demo, start
from sojourn_bringup.instance import RoleTokens
from sojourn_config.command_errors import UsageError

SHORT = ("--set", "duration_limit_s=0.4", "--without", "arm")


def test_it_runs_beside_a_run_on_its_domain(tmp_path: Path, domain: int, capsys: pytest.CaptureFixture[str]) -> None:
    place = ["--domain", str(domain), "--run-dir", str(tmp_path / "run")]
    with RoleTokens(domain, "", ("plant", "sensors", "drive", "operator", "recorder")):
        status = start.main(["flat_drive", "--direct", *SHORT, *place])
    said = capsys.readouterr().out
    assert status == 1 and "timed out" in said and "the run's limit of 0.4 s is over" in said
    bag = read_bag(tmp_path / "run")
    assert bag.whole and bag["/clock"].times[-1] == pytest.approx(0.5, abs=0.05)
    assert len(bag["/drive_command"]) == len(bag["/clock"])


def test_a_run_that_nobody_commands_ends_at_its_limit(
    tmp_path: Path, domain: int, capsys: pytest.CaptureFixture[str]
) -> None:
    place = ["--domain", str(domain), "--run-dir", str(tmp_path / "run"), "--set", "steps=[]"]
    assert start.main(["flat_drive", "--direct", *SHORT, *place]) == 0
    said = capsys.readouterr().out
    assert "it ends at its limit of 0.4 s" in said and "Ctrl-C" not in said
    assert read_bag(tmp_path / "run")["/clock"].times[-1] == pytest.approx(0.4, abs=0.05)


def test_the_demo_writes_its_summary_and_picture(tmp_path: Path, domain: int) -> None:
    place = ["--domain", str(domain), "--run-dir", str(tmp_path / "run")]
    with RoleTokens(domain, "", ("plant",)):
        assert demo.main(["--scenario", "flat_drive", "--direct", "--set", "duration_limit_s=0.4", *place]) == 1
    assert (tmp_path / "run" / "report.png").stat().st_size > 10_000
    assert (tmp_path / "run" / "summary.json").is_file()


@pytest.mark.parametrize("option", [("--realtime",), ("--only", "plant,sensors"), ("--replace", "drive=true")])
def test_what_it_does_not_go_with(option: tuple[str, ...], tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--direct runs"):
        start.main(["flat_drive", "--direct", *option, "--run-dir", str(tmp_path / "run")])
    assert not (tmp_path / "run").exists()
