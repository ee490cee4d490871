"""A run that is kept at even times: what goes on from a checkpoint is the unbroken run, its bag and its contract."""

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sojourn_bags.errors import ReplayError
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, bag_file, read_bag
from sojourn_bags.replay_script import script_of
from sojourn_bags.summary import summarise
from sojourn_bringup import start
from sojourn_bringup.checkpoints import _digests, last_before, resume
from sojourn_config.command_errors import UsageError
from sojourn_config.paths import config_folder
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_machine.evolution import replace
from sojourn_operator.scenario_steps import prepare_scenario
from sojourn_stack.checkpoint import Origin, read, save
from sojourn_stack.run import RunSpec, begun

SHORT = ("--direct", "--set", "duration_limit_s=6.0", "--set", "steps=[{drive_to: {x: 0.2, y: 0.0}}, {wait_s: 1.0}]")
BEGUN = 200


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that is kept every two seconds."""
    folder = tmp_path_factory.mktemp("unbroken") / "run"
    start.main(["flat_drive", *SHORT, "--checkpoint-every", "2", "--run-dir", str(folder)])
    return folder


@pytest.fixture(scope="module")
def gone_on(unbroken: Path) -> Path:
    """The folder of the run that goes on after four seconds."""
    folder = unbroken.with_name("gone_on")
    start.main(["--resume", str(kept(unbroken)), "--checkpoint-every", "1", "--run-dir", str(folder)])
    return folder


def kept(run: Path, second: int = 4) -> Path:
    return run / "checkpoints" / f"{second:05d}.00.checkpoint"


def after(bag: Bag, period: int) -> dict[str, list[tuple[int, bytes]]]:
    """Log times and bytes of all that belongs to later control periods, by topic."""
    begin = period * CONTROL_PERIOD_NS
    return {
        name: [(at, data) for at, data in zip(one.log_times, one.data, strict=True) if at > begin]
        for name, one in bag.topics.items()
        if one.log_times[-1] > begin
    }


def test_it_is_kept_at_even_times(unbroken: Path, gone_on: Path) -> None:
    assert [file.stem for file in sorted((unbroken / "checkpoints").iterdir())] == ["00002.00", "00004.00", "00006.00"]
    assert [file.stem for file in sorted((gone_on / "checkpoints").iterdir())] == ["00005.00", "00006.00"]


def test_it_goes_on_bit_for_bit_and_its_bag_is_whole(unbroken: Path, gone_on: Path) -> None:
    first, second = read_bag(unbroken), read_bag(gone_on)
    assert after(second, BEGUN) == after(first, BEGUN)
    assert set(after(second, BEGUN)) == set(second.topics) >= {"/truth/odom", "/joint_states", "/diagnostics", "/tf"}
    assert all(messages.log_times[0] > BEGUN * CONTROL_PERIOD_NS for messages in second.topics.values())
    assert second.records["sojourn_completeness"]["complete"] == first.records["sojourn_completeness"]["complete"]
    assert second.records["sojourn_completeness"]["gaps"] == "" == first.records["sojourn_completeness"]["gaps"]
    assert second.records["sojourn_run"]["resumed_at_ns"] == str(BEGUN * CONTROL_PERIOD_NS)


def test_its_bag_keeps_the_contract_and_is_told_of(gone_on: Path) -> None:
    bag = read_bag(gone_on)
    report, _ = judge_bag(bag)
    assert not report.groups, report.groups
    summary = summarise(bag)
    assert summary["steps_not_sent"] == 0
    (goal,) = (one["goal"] for one in summary["goals"])
    assert goal == "drive to (0.20, 0.00), asked for before this record"
    assert summary["verdict"].startswith(f"Under way when the record ended, 1 of 1 goals: {goal}, ")
    with pytest.raises(ReplayError, match="begins at a checkpoint"):
        script_of(bag, "drive")


@pytest.mark.parametrize(("second", "said"), [(2, True), (12, False)])
def test_a_goal_that_was_under_way_is_judged_in_what_goes_on(tmp_path: Path, second: int, said: bool) -> None:
    steps = "steps=[{drive_to: {x: -0.6, y: 0.0}}, {wait_s: 8.0}]"
    start.main(
        ["flat_drive", "--direct", "--set", steps, "--checkpoint-every", "2", "--run-dir", str(tmp_path / "run")]
    )
    whole = summarise(read_bag(tmp_path / "run"))
    assert start.main(["--resume", str(kept(tmp_path / "run", second)), "--run-dir", str(tmp_path / "on")]) == 0
    part = summarise(read_bag(tmp_path / "on"))
    if not said:
        assert not part["goals"] and part["verdict"].startswith("No goals were asked for in this record")
        return
    (first,), (last,) = whole["goals"], part["goals"]
    assert last["goal"] == "drive to (-0.60, 0.00), asked for before this record"
    assert (last["outcome"], last["end_s"]) == (first["outcome"], first["end_s"]) == ("reached", first["end_s"])
    assert last["error_m"] == pytest.approx(first["error_m"], abs=1e-9) and part["all_met"]


def test_with_other_values_it_branches_off(unbroken: Path) -> None:
    folder = unbroken.with_name("branch")
    soft = (
        "--set",
        "soil.k_phi=200000.0",
        "--set",
        "faults=[{joint: wheel_rear_left_joint, kind: motor_dead, at: 4.5}]",
    )
    start.main(["--resume", str(kept(unbroken)), *soft, "--run-dir", str(folder)])
    one, other = after(read_bag(unbroken), BEGUN)["/truth/odom"], after(read_bag(folder), BEGUN)["/truth/odom"]
    assert one[0] == other[0], "it begins where the run stood"
    assert one[-1] != other[-1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--machine", "skid"], "does not go with --machine: .*the machine and the roles that it has"),
        (["--without", "drive", "--realtime"], "--realtime and --without"),
        (["--set", "sensors.hazcam=null"], r"another state \(sensors\.sensors: "),
        (["--set", "sensors.sun=null"], "another state"),
        (["--set", "battery_soc=0.1"], "battery_soc is of the start, which is over: allowed is what acts from 4 s on"),
        (["--set", "start.x=1.0"], "start is of the start, which is over"),
        (["--seed", "99"], "seed is of the start, which is over"),
        (["--set", "terrain.size_x=30.0"], "terrain is of the start, which is over"),
        (["--set", "steps[0].drive_to.x=5.0"], r"steps\[0\] has begun: allowed is .* its steps from steps\[1\]"),
        (["--set", "steps=[]"], r"steps\[0\] has begun"),
    ],
)
def test_what_it_does_not_go_with(unbroken: Path, tmp_path: Path, arguments: list[str], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        start.main(["--resume", str(kept(unbroken)), *arguments, "--run-dir", str(tmp_path / "run")])
    assert not (tmp_path / "run").exists()


def test_what_has_not_begun_may_be_another(unbroken: Path) -> None:
    """The drive of the first step goes on at two seconds: it may take longer, and what follows may be another step."""
    steps = "steps=[{drive_to: {x: 0.2, y: 0.0}, timeout_s: 50.0}, {wait_s: 0.5}]"
    branch = resume(kept(unbroken, 2), [steps])
    assert [step.timeout_s for step in branch.scenario.loaded.config.steps] == [50.0, None]
    with pytest.raises(UsageError, match=r"steps\[0\] has begun: .* and the time-out of the step that goes on"):
        resume(kept(unbroken, 2), ["steps=[{drive_to: {x: 0.3, y: 0.0}}, {wait_s: 0.5}]"])


@pytest.mark.parametrize("way", [["--realtime"], ["--composed", "--realtime"]])
def test_only_a_run_in_one_process_and_lock_step_is_kept(tmp_path: Path, way: list[str]) -> None:
    with pytest.raises(UsageError, match=r"--checkpoint-every does not go with --realtime: in real time no two nodes"):
        start.main(["flat_drive", *way, "--checkpoint-every", "2", "--run-dir", str(tmp_path / "run")])


def test_it_goes_on_from_the_last_checkpoint_of_a_bag_before_a_time(unbroken: Path, tmp_path: Path) -> None:
    bag = unbroken / "bag"
    for path, at, second in ((unbroken, 5.98, 4), (bag, 4.0, 4), (bag_file(bag), 2.02, 2), (bag, math.inf, 6)):
        assert last_before(path, at) == kept(unbroken, second)
    with pytest.raises(UsageError, match=r"--at 1\.98: the first checkpoint of .* is of 2 s: allowed is from there on"):
        start.main(["--from", str(unbroken), "--at", "1.98", "--run-dir", str(tmp_path / "run")])
    with pytest.raises(UsageError, match="--from does not go with --realtime"):
        start.main(["--from", str(unbroken), "--realtime", "--run-dir", str(tmp_path / "run")])
    shutil.copytree(bag, tmp_path / "alone" / "bag")
    with pytest.raises(UsageError, match="its run has kept no checkpoint: allowed is one with --checkpoint-every"):
        last_before(tmp_path / "alone", 4.0)
    with pytest.raises(UsageError, match=r"--from .*nowhere cannot be read as a bag"):
        last_before(tmp_path / "nowhere", 4.0)
    start.main(["--from", str(unbroken), "--at", "4.5", "--run-dir", str(tmp_path / "run")])
    assert after(read_bag(tmp_path / "run"), BEGUN) == after(read_bag(unbroken), BEGUN)


@pytest.mark.parametrize(
    "what",
    [
        "steps=[{wait_s: 1.0}]",
        "faults=[{joint: wheel_rear_left_joint, kind: motor_dead, at: 3.0}]",
        "link={light_time_s: 1.3}",
    ],
)
def test_without_an_operator_a_branch_has_nothing_that_one_would_carry_out(tmp_path: Path, what: str) -> None:
    """It was taken, and nothing came of it: the run stood, and never ended."""
    scenario = prepare_scenario("flat_drive", ["steps=[{arm_joints: {name: stow}}]"])
    roles = ("plant", "sensors", "drive", "power")
    stack, state, _, _ = begun(RunSpec(scenario.name, roles, scenario.overrides, None, scenario.loaded))
    state, _ = stack.step(state)
    file = tmp_path / "one.checkpoint"
    save(state, file, Origin(scenario.name, scenario.overrides, roles, _digests(scenario.loaded)))
    with pytest.raises(UsageError, match=r"carried out by the role operator, which takes no part"):
        resume(file, [what])
    assert resume(file, ["soil.k_phi=200000.0"]).participants == roles


def test_faults_of_before_are_told_of_and_those_of_a_branch_come(tmp_path: Path) -> None:
    """A schedule of other faults goes on from one whose faults have come, and is not taken for it."""
    expect = "expect: {topic: /drive/status, field: state, says: nothing of this, within: 0.5}"
    early = f"faults=[{{joint: wheel_rear_left_joint, kind: motor_weak, part: 0.9, at: 0.5, until: 0.7, {expect}}}]"
    short = ("--without", "arm", "--set", early, "--set", "duration_limit_s=1.5", "--checkpoint-every", "1")
    start.main(["flat_drive", *SHORT, *short, "--run-dir", str(tmp_path / "1")])
    start.main(["--from", str(tmp_path / "1"), "--run-dir", str(tmp_path / "same")])
    same = summarise(read_bag(tmp_path / "same"))
    assert [(one["outcome"], one["begin_s"], one["end_s"]) for one in same["faults"]] == [
        ("came before this record", 0.5, 0.7)
    ]
    assert "did not come" not in same["verdict"] and same["faults_met"]
    late = "faults=[{joint: wheel_rear_right_joint, kind: motor_dead, at: 1.2}]"
    start.main(["--from", str(tmp_path / "1"), "--set", late, "--run-dir", str(tmp_path / "other")])
    came = {one["fault"]: one["begin_s"] for one in summarise(read_bag(tmp_path / "other"))["faults"]}
    assert came == {"motor_dead wheel_rear_right_joint": 1.2, "motor_weak wheel_rear_left_joint": 0.5}


@pytest.mark.parametrize(
    "arguments", [[], ["flat_drive", "--resume", "some.checkpoint"], ["--resume", "one", "--from", "two"]]
)
def test_it_is_a_scenario_or_a_checkpoint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        start.main(arguments)
    assert ended.value.code == 2 and "--resume FILE or --from BAG, which know their own" in capsys.readouterr().err


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("no checkpoint", "utf-8")
    for name, words in (("text", "no checkpoint"), ("nowhere", "No such file"), (".", "directory")):
        with pytest.raises(UsageError, match=words):
            resume(tmp_path / name)


def test_files_that_have_changed_since_are_named(tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    shutil.copy(config_folder() / "scenarios" / "flat_drive.yaml", own)
    start.main([str(own), *SHORT, "--checkpoint-every", "1", "--without", "arm", "--run-dir", str(tmp_path / "run")])
    file = kept(tmp_path / "run", 1)
    assert "arm" not in resume(file).participants
    own.write_text(own.read_text("utf-8") + "\n# another word\n", "utf-8")
    with pytest.raises(UsageError, match=r"own\.yaml changed since: .*--set KEY=VALUE"):
        resume(file)


@pytest.mark.parametrize(
    ("role", "way", "value", "words"),
    [
        ("plant", ("machine", "velocity"), np.zeros(3), r"float64 \(3,\) and the run begins with float64 \(\d+,\)"),
        ("plant", ("machine", "velocity"), np.zeros(31, np.float32), "float32 .* and the run begins with float64"),
        ("plant", ("machine", "velocity"), 5.0, "a float, and the run begins with a ndarray"),
        ("drive", ("drive", "odometry", "x"), "far", "a str, and the run begins with a float"),
        ("drive", (), None, "a NoneType, and the run begins with a "),
    ],
)
def test_a_state_that_is_none_of_its_run_is_refused_in_words(
    unbroken: Path, tmp_path: Path, role: str, way: tuple[str, ...], value: object, words: str
) -> None:
    """These were tracebacks once the run went on, and an array was read beyond its end."""

    def put(whole: Any, rest: tuple[str, ...]) -> Any:
        return replace(whole, **{rest[0]: put(getattr(whole, rest[0]), rest[1:])}) if rest else value

    state, origin = read(kept(unbroken))
    save(replace(state, roles={**state.roles, role: put(state.roles[role], ("app", *way))}), tmp_path / "one", origin)
    with pytest.raises(UsageError, match=rf"it is no state of its run \({'.'.join((role, *way))}: {words}"):
        resume(tmp_path / "one")
