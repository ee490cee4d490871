"""What can be asked of scripts/start.py, and the one sentence that answers what cannot."""

import argparse
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_bringup import demo, demonstration, start, start_run
from sojourn_bringup.instance import RoleInUseError, RoleTokens
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.process_table import ROLE_NAMES
from sojourn_bringup.run_folder import make_run_folder
from sojourn_bringup.screen import Screen
from sojourn_config import command_line
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.errors import ConfigError
from sojourn_operator import goal_client

DOMAIN = "231"


class Lines(Screen):
    """Keeps what is said."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[str] = []

    def say(self, text: str) -> None:
        self.said.append(text)


def plan_of(tmp_path: Path, *arguments: str, scenario: str = "flat_drive") -> tuple[RunPlan, list[str]]:
    screen = Lines()
    words = [scenario, "--domain", DOMAIN, "--run-dir", str(tmp_path / "run"), *arguments]
    return start_run.make_plan(start.parser().parse_args(words), screen), screen.said


def test_everything_takes_part_unless_told_otherwise(tmp_path: Path) -> None:
    plan, said = plan_of(tmp_path)
    assert plan.participants == plan.started == ROLE_NAMES
    assert not said and not plan.realtime and plan.run_dir.is_dir()


def test_a_machine_that_the_sun_never_reaches_is_told_of_before_the_run(tmp_path: Path) -> None:
    _, said = plan_of(tmp_path, "--set", "site.latitude_deg=85.0", scenario="mars_sol")
    assert said == [
        "note: in the solar day from its start on the Sun does not rise at the site on mars: explorer_solar has what "
        "is in its stores"
    ]


def test_loads_above_all_sources_are_told_of_before_the_run(tmp_path: Path) -> None:
    """A generator of 110 W, and beside receiver and heater, of 17 W, a computer of 93 or of 94 W."""
    worn = ("--set", "sources.generator.degradation_per_year=0.0")
    (tmp_path / "enough").mkdir()
    (tmp_path / "short").mkdir()
    enough = plan_of(tmp_path / "enough", *worn, "--set", "bus.loads[0].power_w=93", scenario="isotope_sol")[1]
    short = plan_of(tmp_path / "short", *worn, "--set", "bus.loads[0].power_w=94", scenario="isotope_sol")[1]
    assert not enough
    assert short == ["note: essential loads take 111 W and all sources give 110 W at most: the stores run empty"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--without", "wheels"], "role 'wheels' is unknown, allowed is one of plant, operator, sensors, drive, arm"),
        (["--only", "plants"], "role 'plants' is unknown, allowed is one of plant"),
        (["--domain", "233"], "allowed is a whole number from 0 to 232"),
        (["--domain", "x"], "domain 'x'"),
        (["--namespace", "2nd"], "a letter first"),
        (["--seed", "-1"], "--seed"),
        (["--lockstep-timeout", "0"], "allowed is a number above 0"),
        (["--lockstep-timeout", "nan"], "'nan' is no number"),
        (["--fast"], "--fast"),
    ],
)
def test_bad_options_are_one_sentence(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        start.parser().parse_args(["flat_drive", *arguments])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line and line.startswith("start.py: ")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--replace", "wheels=run"], "role 'wheels' is unknown, allowed is one of plant"),
        (["--replace", "drive"], "allowed is NAME=COMMAND"),
        (["--replace", "drive="], "allowed is NAME=COMMAND"),
        (["--replace", "drive='run"], "cannot be read"),
        (["--replace", "drive=one", "--replace", "drive=two"], "names drive twice: one and two"),
        (["--replace", "drive=run", "--without", "drive"], "--replace names drive, which is not started here"),
        (["--replace", "drive=run", "--only", "arm"], "--replace names drive, which is not started here"),
        (["--replace", "drive=run", "--composed"], "--composed"),
        (["--only", "plant", "--composed"], "--composed"),
        (["--shadow", "wheels=run"], "role 'wheels' is unknown, allowed is one of plant"),
        (["--shadow", "drive"], "--shadow drive: allowed is NAME=COMMAND"),
        (["--shadow", "plant=run"], "--shadow names plant, allowed is one of sensors, drive, arm, power"),
        (["--shadow", "drive=run", "--without", "drive,operator"], "--shadow names drive, which does not take part"),
        (["--shadow", "drive=run", "--composed"], "--composed"),
        (["--only", "arm", "--without", "arm"], "--only and --without both name arm"),
        (["--without", "plant"], "nothing moves without plant"),
        (["--without", "sensors"], "in lock-step drive cannot run without sensors"),
    ],
)
def test_wishes_that_do_not_go_together_are_one_sentence(tmp_path: Path, arguments: list[str], words: str) -> None:
    with pytest.raises(UsageError) as refused:
        plan_of(tmp_path, *arguments)
    assert words in str(refused.value) and "\n" not in str(refused.value)
    assert refused.value.exit_status == 2
    assert not (tmp_path / "run").exists()


def test_a_scenario_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="lunar_sample"):
        plan_of(tmp_path, scenario="lunar_sampel")


@pytest.mark.parametrize("override", ["battery_soc=7", "nonsense=1", "soil.k_c=grains"])
def test_a_bad_override_starts_nothing(tmp_path: Path, override: str) -> None:
    with pytest.raises(ConfigError):
        plan_of(tmp_path, "--set", override)
    assert not (tmp_path / "run").exists()


def test_seed_and_overrides_reach_every_node(tmp_path: Path) -> None:
    plan, _ = plan_of(tmp_path, "--set", "battery_soc=0.5", "--seed", "9", "--namespace", "moon/one")
    for role in ROLE_NAMES:
        words = plan.ros_arguments(role)
        assert 'overrides:=["battery_soc=0.5", "seed=9"]' in words and "__ns:=/moon/one" in words
        assert ("bag" in plan.parameters(role)) == (role == "recorder")


@pytest.mark.parametrize("role", ["drive", "arm"])
def test_no_operator_where_its_steps_lack_their_receiver(tmp_path: Path, role: str) -> None:
    lunar, said = plan_of(tmp_path, "--without", role, scenario="lunar_sample")
    assert set(ROLE_NAMES) - set(lunar.participants) == {role, "operator"}
    assert said == [f"the operator is left out too: its steps need {role}"]


def test_no_operator_without_steps(tmp_path: Path) -> None:
    plan, said = plan_of(tmp_path, "--set", "steps=[]", "--only", "plant,sensors")
    assert "operator" not in plan.participants and len(said) == 1
    assert set(plan.started) == {"plant", "sensors"}
    assert set(plan.participants) - set(plan.started) == {"drive", "arm", "power", "recorder"}


FAULTS = "faults=[{kind: motor_dead, joint: wheel_rear_left_joint, at: 1.0}]"


def test_faults_have_an_operator_who_sends_them(tmp_path: Path) -> None:
    """Without steps, or without who carries them out, they did nothing, and the verdict said that they did not come."""
    plan, said = plan_of(tmp_path, "--set", "steps=[]", "--set", FAULTS)
    assert "operator" in plan.participants and not said
    for others in (("--without", "operator"), ("--without", "arm")):
        with pytest.raises(
            UsageError, match=r"the faults are sent by the role operator, left out here: put faults=\[\]"
        ):
            plan_of(tmp_path, "--set", FAULTS, *others, scenario="lunar_sample")


def test_what_is_kept_for_a_node_is_not_its_shadow_s(tmp_path: Path) -> None:
    """A candidate wrote its own pose and goal to where the next process of the drive itself would have looked."""
    plan, _ = plan_of(tmp_path, "--realtime", "--shadow", "drive=run")
    assert {"kept", "restarts"} <= plan.parameters("drive").keys()
    assert plan.parameters("drive").keys() - plan.candidate_parameters("drive").keys() == {"kept", "restarts"}


def test_run_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "run"):
        with pytest.raises(UsageError, match="cannot be written") as refused:
            make_run_folder(folder)
        assert str(folder) in str(refused.value)


def test_run_folder_that_holds_a_run(tmp_path: Path) -> None:
    (tmp_path / "bag").mkdir()
    with pytest.raises(UsageError, match="holds a run already"):
        make_run_folder(tmp_path)


def test_runs_of_one_second_get_a_folder_each_and_latest_is_the_last(tmp_path: Path) -> None:
    folders = [make_run_folder(None, tmp_path / "runs") for _ in range(3)]
    assert len(set(folders)) == 3
    assert (tmp_path / "runs" / "latest").resolve() == folders[-1]


def test_latest_that_is_a_folder_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "runs" / "latest" / "mine").mkdir(parents=True)
    with pytest.raises(UsageError, match="latest"):
        make_run_folder(None, tmp_path / "runs")
    assert (tmp_path / "runs" / "latest" / "mine").is_dir()


def test_a_role_is_held_by_one_run_at_a_time(tmp_path: Path) -> None:
    with RoleTokens(231, "", ("plant", "drive")):
        with pytest.raises(RoleInUseError, match="domain 231 is in use: a run on this machine has a plant there"):
            plan_of(tmp_path)
        assert not (tmp_path / "run").exists()
        with RoleTokens(231, "/other", ("plant",)), RoleTokens(230, "", ("plant",)), RoleTokens(231, "", ("arm",)):
            pass
    with RoleTokens(231, "", ("plant", "drive")):
        pass
    assert issubclass(RoleInUseError, CommandError) and RoleInUseError.exit_status == 1


def test_the_demo_passes_its_wishes_on_and_answers_under_its_own_name(capsys: pytest.CaptureFixture[str]) -> None:
    given_to_demo = demo.parser().parse_args(["--seed", "4", "--set", "a=1", "--domain", "9", "--run-dir", "x"])
    passed = start.parser("demo").parse_args(demonstration.start_arguments(given_to_demo))
    assert (passed.scenario, passed.seed, passed.set, passed.domain) == ("lunar_sample", 4, ["a=1"], 9)
    assert passed.run_dir == Path("x")
    with pytest.raises(SystemExit):
        start.parser("demo").parse_args(demonstration.start_arguments(demo.parser().parse_args(["--seed", "x"])))
    assert capsys.readouterr().err.startswith("demo: ")


@pytest.mark.parametrize(
    "arguments", [[], ["drive"], ["drive", "1"], ["drive", "1", "inf"], ["arm", "1", "2"], ["jump"], ["stop", "1"]]
)
def test_goals_that_are_none_are_one_sentence(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        goal_client.parser().parse_args(arguments)
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@given(st.text(max_size=12))
def test_a_namespace_is_a_name_of_ros_or_is_refused(text: str) -> None:
    try:
        name = command_line.namespace(text)
    except argparse.ArgumentTypeError:
        return
    assert name == "" or all(part[0].isalpha() and part.replace("_", "a").isalnum() for part in name[1:].split("/"))


def test_a_rover_without_an_arm_has_no_role_arm(tmp_path: Path) -> None:
    plan, said = plan_of(tmp_path, "--machine", "skid")
    assert plan.participants == tuple(role for role in ROLE_NAMES if role != "arm")
    assert plan.overrides == ("machine=skid",)
    assert not said
    for asked in (["--only", "arm"], ["--replace", "arm=true"], ["--shadow", "arm=true"]):
        with pytest.raises(UsageError, match="the machine skid has no arm"):
            plan_of(tmp_path / "x", "--machine", "skid", *asked)


def test_a_machine_that_stands_fast_has_no_role_drive(tmp_path: Path) -> None:
    plan, said = plan_of(tmp_path, scenario="puma560_course")
    assert plan.participants == tuple(role for role in ROLE_NAMES if role != "drive") and not said
    for asked in (["--only", "drive"], ["--replace", "drive=true"], ["--shadow", "drive=true"]):
        with pytest.raises(UsageError, match="puma560 stands fast, it has no wheels: there is no role drive"):
            plan_of(tmp_path / "x", *asked, scenario="puma560_course")


def test_the_demonstration_of_a_rover_takes_its_own_course_or_the_common_one() -> None:
    assert demonstration.scenario_of(None, None) == "lunar_sample"
    assert demonstration.scenario_of(None, "skid") == "machine_course"
    assert demonstration.scenario_of(None, "micro") == "micro_course"
    assert demonstration.scenario_of(None, "ssrms") == "ssrms_course"
    assert demonstration.scenario_of("flat_drive", "micro") == "flat_drive"


def test_a_reader_that_has_had_enough_brings_no_traceback() -> None:
    script = (
        "from sojourn_config.command_line import run_script\n"
        "def main(arguments):\n"
        "    print('line\\n' * 100_000)\n"
        "    return 0\n"
        "run_script(main, [])\n"
    )
    program = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout is not None and program.stderr is not None
    program.stdout.readline()
    program.stdout.close()
    assert program.stderr.read() == ""
    assert program.wait(20) == 141
