"""Candidates beside the nodes of a run: compared, told of, and not acted upon."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

from programs import PATIENT, SHORT_RUN, Program
from verdicts import require_same

from sojourn_bags.reading import read_bag

FLIGHT_DRIVE = f"{sys.executable} {Path(__file__).parent / 'flight_drive.py'}"
OUR_ARM = f"{sys.executable} -m sojourn_arm"
MOVE = "steps=[{drive_to: {x: 0.06, y: 0.02}, timeout_s: 40}, {arm_joints: {name: stow}, timeout_s: 30}, {wait_s: 8.0}]"


def test_shadows_are_judged_and_change_nothing(tmp_path: Path, start: Callable[..., Program], domain: int) -> None:
    """Our own arm beside our arm says the same; another drive does not, and the run is the one without them."""
    options = [SHORT_RUN, *PATIENT, "--set", MOVE, "--domain", domain]
    shadows = ["--shadow", f"drive={FLIGHT_DRIVE}", "--shadow", f"arm={OUR_ARM}"]
    beside = start("start", *options, *shadows, "--run-dir", tmp_path / "beside")
    assert beside.wait() == 0, beside.text
    assert not beside.processes()
    alone = start("start", *options, "--composed", "--run-dir", tmp_path / "alone")
    assert alone.wait() == 0, alone.text
    runs = [read_bag(tmp_path / name) for name in ("beside", "alone")]
    require_same(runs[0], runs[1])

    arm, drive = (json.loads((tmp_path / "beside" / f"shadow_{role}.json").read_text()) for role in ("arm", "drive"))
    assert (arm["state"], arm["detail"]) == ("done", "identical"), arm["lines"]
    periods = len(runs[0]["/arm_command"])
    (commands,) = (topic for topic in arm["result"]["topics"] if topic["topic"] == "/arm_command")
    assert commands["matched"] == periods
    assert (drive["state"], drive["detail"]) == ("done", "different")
    assert any("/drive_command" in line for line in drive["lines"])
    assert "shadow of drive: differs from ours since" in beside.text
    assert "shadow of arm: differs" not in beside.text

    both = read_bag(tmp_path / "beside" / "shadow_drive")
    assert len(both["/drive_command"]) == len(both["/shadow/drive_command"]) == periods


def test_a_shadow_that_cannot_start_stops_the_run_before_it_begins(
    tmp_path: Path, start: Callable[..., Program], domain: int
) -> None:
    refused = start("start", SHORT_RUN, "--shadow", "power=false", "--domain", domain, "--run-dir", tmp_path / "run")
    assert refused.wait() == 1
    assert "shadow of power: power (process" in refused.text and "ended with status 1" in refused.text
    assert not refused.processes()


def test_a_shadow_that_dies_is_told_of_and_the_run_goes_on(
    tmp_path: Path, start: Callable[..., Program], domain: int
) -> None:
    """It is killed as a process would be: from outside, in the middle."""
    program = tmp_path / "dies.py"
    program.write_text(
        "import sojourn_arm.node as arm\n"
        "period = arm.ArmNode.on_period\n"
        "def die(self, stamp, inputs, goals):\n"
        "    if stamp > 500_000_000: raise SystemExit(7)\n"
        "    period(self, stamp, inputs, goals)\n"
        "arm.ArmNode.on_period = die\n"
        "arm.main()\n"
    )
    options = [SHORT_RUN, *PATIENT, "--set", "steps=[{wait_s: 2.0}]", "--domain", domain]
    run = start("start", *options, "--shadow", f"arm={sys.executable} {program}", "--run-dir", tmp_path / "run")
    assert run.wait() == 0, run.text
    assert "shadow of arm: arm (process" in run.text and "ended with status 7" in run.text
    assert not run.processes()
