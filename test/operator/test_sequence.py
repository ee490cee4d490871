"""Sequences of commands: what a file may say, when a step begins, what its end and an operator's words lead to."""

from functools import partial
from pathlib import Path

import pytest
import yaml

from sojourn_bags.reading import read_bag
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.codecs import decode
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import STANDARD
from sojourn_machine.status_keys import KEYS
from sojourn_operator.sequence.condition import conditions
from sojourn_operator.sequence.file import SequenceConfig, read_sequence, scenario_text, sequence_text
from sojourn_operator.sequence.runner import SequenceInput, SequenceRunner, SequenceState
from sojourn_operator.sequence.stream import dropped_s
from sojourn_operator.sequence_command import main
from sojourn_operator.steps.step import LEAD_NS, GoalReport, RunFacts

REPLAY = Path(__file__).parents[1] / "replay"
CHARGE = "/battery_state.percentage"
DRIVE = {"drive_to": {"x": 1.0, "y": 0.0}}


@pytest.fixture(scope="module")
def skid() -> LoadedScenario:
    return load_scenario("flat_drive", ["machine=skid"])


def runner(*steps: dict[str, object]) -> SequenceRunner:
    return SequenceRunner(SequenceConfig.model_validate({"steps": list(steps)}), STANDARD, RunFacts())


class Run:
    """A runner that is looked at ten times a second; the drive ends each goal as it is told to after a second."""

    def __init__(self, one: SequenceRunner, ends: str = "reached") -> None:
        self.one, self.ends = one, ends
        self.state: SequenceState = one.initial_state()
        self.now, self.values, self.sent = NANOSECONDS, {}, []
        self.reports: dict[str, GoalReport] = {}
        self._goal = (0, 0)

    def go(self, seconds: float, **values: float | str) -> "Run":
        self.values |= values
        for _ in range(round(10 * seconds)):
            begun, stamp = self._goal
            if stamp and self.now - begun >= NANOSECONDS:
                self.reports = {"drive": GoalReport(self.ends, stamp, "because")}
            self.take(self.one.look(self.state, self.now, SequenceInput(self.reports, self.values)))
            self.now += NANOSECONDS // 10
        return self

    def take(self, answer: tuple[SequenceState, list]) -> None:
        self.state, goals = answer
        for goal in goals:
            self.sent.append(goal.topic)
            if goal.topic == "/goal_pose":
                assert goal.message.stamp == self.now + LEAD_NS
                self._goal = self.now, goal.message.stamp

    @property
    def outcomes(self) -> list[str]:
        return [entry.outcome for entry in self.state.history]


def test_each_step_begins_when_the_one_before_it_has_come_to_its_end() -> None:
    run = Run(runner(DRIVE, {"wait_s": 0.5}, DRIVE)).go(6.0)
    assert run.outcomes == ["reached", "waited", "reached"] and run.sent == ["/goal_pose", "/goal_pose"]
    assert run.state.phase == "ended" and run.one.is_good(run.state)
    stamps = [entry.stamp for entry in run.state.history]
    assert stamps == sorted(stamps) and stamps[1] - stamps[0] >= 0.5 * NANOSECONDS


def test_a_step_waits_for_its_time_and_its_comparisons() -> None:
    run = Run(runner({**DRIVE, "when": f"{CHARGE} > 0.4 and /drive/status.state == idle", "after_s": 2.0}))
    run.values = {CHARGE: 0.5, "/drive/status.state": "idle"}
    assert run.go(1.9).sent == []
    run.values[CHARGE] = 0.3
    assert run.go(2.0).sent == [] and "0.4" in run.one.waits_for(run.state, run.now, SequenceInput({}, run.values))
    run.values[CHARGE] = 0.5
    assert run.go(0.2).sent == ["/goal_pose"]


def test_a_comparison_of_what_has_not_come_does_not_hold_and_its_limit_fails_the_step() -> None:
    run = Run(runner({**DRIVE, "when": f"{CHARGE} > 0.4", "within_s": 1.0, "on_failure": "skip"}, {"wait_s": 0.1}))
    run.go(3.0)
    assert run.outcomes == ["timed out", "waited"] and run.sent == []
    assert not run.one.is_good(run.state)


@pytest.mark.parametrize(
    ("after", "outcomes", "phase"),
    [("hold", ["stopped"], "waiting"), ("skip", ["stopped", "waited"], "ended"), ("abort", ["stopped"], "aborted")],
)
def test_what_a_failure_leads_to(after: str, outcomes: list[str], phase: str) -> None:
    run = Run(runner({**DRIVE, "on_failure": after}, {"wait_s": 0.1}), "stopped").go(3.0)
    assert (run.outcomes, run.state.phase) == (outcomes, phase)
    assert run.sent == (["/goal_pose", "/cmd_vel"] if after == "abort" else ["/goal_pose"])


def test_a_step_that_takes_too_long_is_stopped() -> None:
    run = Run(runner({**DRIVE, "timeout_s": 0.5})).go(1.0)
    assert run.outcomes == ["timed out"] and run.sent == ["/goal_pose", "/cmd_vel"]


def test_an_operator_holds_resumes_skips_and_aborts() -> None:
    one = runner(DRIVE, {"wait_s": 0.1, "hold": True}, DRIVE, DRIVE)
    run = Run(one).go(0.5)
    run.state = one.hold(run.state, "anna", run.now)
    run.go(3.0)  # what is under way comes to its end
    assert run.outcomes == ["done", "reached"] and "anna" in one.describe(run.state)
    run.state = one.resume(run.state, "anna", run.now)
    run.go(0.5)
    assert run.outcomes[-1] == "waited" and run.sent == ["/goal_pose"] * 2
    run.take(one.skip(run.state, "anna", run.now))
    run.go(0.2)
    assert run.sent == ["/goal_pose", "/goal_pose", "/cmd_vel", "/goal_pose"]
    run.take(one.abort(run.state, "ben", run.now, "enough"))
    run.go(1.0)
    assert run.state.phase == "aborted" and run.sent[-1] == "/cmd_vel"
    assert [entry.who for entry in run.state.history][-2:] == ["anna", "ben"]
    assert "ben: drive to (1.00, 0.00): aborted (enough)" in run.state.history[-1].line()


def test_values_are_those_of_the_fields_that_are_compared() -> None:
    one = runner({**DRIVE, "when": "/drive/status.slip < 0.5 and /drive/status.state != failed"})
    message = status_message(1, "drive", {"slip": "0.25", "state": "moving", "mode": "goal"})
    assert one.values("/drive/status", message) == {"/drive/status.slip": 0.25, "/drive/status.state": "moving"}
    assert one.topics == ("/drive/status",)


@pytest.mark.parametrize(
    ("text", "value", "holds"),
    [
        (f"{CHARGE} > 0.4", 0.5, True), (f"{CHARGE} > 0.4", 0.4, False), (f"{CHARGE} >= 0.4", 0.4, True),
        (f"{CHARGE} <= 0.4", 0.5, False), (f"{CHARGE}<0.4", 0.3, True), (f"{CHARGE} == 0.5", 0.5, True),
        (f"{CHARGE} > 0.4", "half", False), (f"{CHARGE} != 0.4", "half", True),
    ],
)  # fmt: skip
def test_comparisons(text: str, value: float | str, holds: bool) -> None:
    (one,) = conditions(text, STANDARD)
    assert one.holds({CHARGE: value}) is holds and not one.holds({})


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("/battery_state.percent > 0.4", CHARGE),
        ("charge > 0.4", "no comparison"),
        (f"{CHARGE} > full", "allowed is == or !="),
        ("/drive/status.stat == reached", "has no such key; the nearest: /drive/status.state"),
        ("/power/status.soc_sigm_1 > 0.1", "the nearest: /power/status.soc_sigma"),
        ("/arm/status.state == reeched", "no such state.*did you mean reached?"),
        ("/drive/status.state != 3", "no such state: allowed is one of failed, idle, moving"),
        ("/diagnostics.state[drive] == stoled", "did you mean stalled?"),
    ],
)
def test_what_is_no_comparison_is_said(text: str, said: str) -> None:
    with pytest.raises(UnknownFieldNameError, match=said):
        conditions(text, STANDARD)


@pytest.mark.parametrize("key", ["slip_front_left", "soc_sigma_1", "somebody_elses", "asked_state"])
def test_a_key_that_may_come_is_taken(key: str) -> None:
    """That of a wheel or a store of which there are several, and that of a role that is somebody else's."""
    assert conditions(f"/drive/status.{key} == 1 and /power/status.{key} == 1", STANDARD)


def test_every_key_and_state_that_our_roles_have_said_is_taken() -> None:
    said = set()
    for folder in sorted(path for path in (REPLAY / "themes").iterdir() if path.is_dir()):
        bag = read_bag(folder)
        for name in (one for one in KEYS if one in bag):
            for message in map(partial(decode, STANDARD.topic(name)), bag[name].data):
                said |= {f"{name}.{key}" for key, _ in message.status[0].values}
                said |= {f"{name}.state == {status_values(message)['state']}"}
    assert len(said) > 100
    for text in said:
        assert conditions(text if "==" in text else f"{text} == idle", STANDARD)


def test_a_file_is_checked_before_anything_is_sent(tmp_path: Path, skid: LoadedScenario) -> None:
    file = tmp_path / "sequence.yaml"

    def said(text: str) -> str:
        file.write_text(text, encoding="utf-8")
        with pytest.raises(ConfigError) as refusal:
            read_sequence(file, skid, STANDARD)
        return str(refusal.value)

    several = said(
        "steps:\n"
        "  - drive_to: {x: 500.0, y: 0.0}\n"
        "  - drive_to: {x: 1.0, y: 0.0}\n    when: /battery_state.percent > 0.4\n"
        "  - arm_joints: {name: unfold}\n"
    )
    assert "sequence.yaml:2" in several and "off the terrain" in several
    assert "sequence.yaml:4" in several and CHARGE in several
    assert "has no arm" in several
    assert "did you mean drive_to?" in said("steps:\n  - drive_too: {x: 1.0, y: 0.0}\n")
    assert "did you mean when?" in (one := said("steps:\n  - drive_to: {x: 1.0, y: 0.0}\n    wen: /x.y > 1\n"))
    assert len(one.splitlines()) == 1  # the one step that was refused makes no empty sequence


def test_steps_go_to_a_scenario_and_back(tmp_path: Path, skid: LoadedScenario) -> None:
    file = tmp_path / "sequence.yaml"
    file.write_text(sequence_text(skid), encoding="utf-8")
    config = read_sequence(file, skid, STANDARD)
    assert [step.on_failure for step in config.steps] == ["abort"]
    steps = yaml.safe_load(scenario_text(config))["steps"]
    again = load_scenario("flat_drive", ["machine=skid", f"steps={yaml.safe_dump(steps, default_flow_style=True)}"])
    assert again.config.steps == skid.config.steps


def test_the_terminal_checks_and_says_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "sequence.yaml"
    file.write_text("steps:\n  - {wait_s: 1.0, hold: true}\n", encoding="utf-8")
    assert main([str(file), "--check", "--scenario", "flat_drive"]) == 0
    assert "1 steps, nothing wrong" in capsys.readouterr().out


def test_time_that_stands_still_sends_a_goal_once() -> None:
    """A run that waits for a node tells the same time again and again: the goal went out at each look."""
    one = runner(DRIVE)
    state, goals = one.look(one.initial_state(), NANOSECONDS, SequenceInput())
    assert [goal.topic for goal in goals] == ["/goal_pose"]
    for now in (NANOSECONDS, NANOSECONDS, 2 * NANOSECONDS):
        state, goals = one.look(state, now, SequenceInput())
        assert not goals


VELOCITY = {"drive_velocity": {"forward": 0.05, "seconds": 1.0}}
JOG = {"arm_jog": {"linear": [0.01, 0.0, 0.0], "seconds": 1.0}}


@pytest.mark.parametrize("step", [VELOCITY, JOG, {"begin": {"step": VELOCITY, "seconds": 3.0}}])
@pytest.mark.parametrize(("apart", "fails"), [(0.2, False), (0.22, True), (0.4, True), (20.0, True)])
def test_a_velocity_that_the_machine_drops_between_two_looks_fails(
    step: dict[str, object], apart: float, fails: bool
) -> None:
    """It drove 0.02 m of 0.25 beside a stack at 8 times real time, which was told as good."""
    one, now, sent = runner({**step, "on_failure": "skip"}), NANOSECONDS, []
    state = one.initial_state()
    for _ in range(30):
        rests = {"arm": GoalReport("stopped", now)}
        state, goals = one.look(state, now, SequenceInput(rests if now > 3 * NANOSECONDS else {}))
        sent += [goal.topic for goal in goals]
        now += round(apart * NANOSECONDS)
    assert state.is_over and one.is_good(state) is not fails
    (entry,) = state.history
    assert ("the stack is too fast for velocities" in entry.reason) is fails
    if fails and apart < 1.0:
        assert entry.outcome == "failed"
        assert sent[-1] == ("/arm/stop" if step is JOG else "/cmd_vel")


def test_how_long_a_machine_waits_for_the_next_velocity_is_its_own_affair() -> None:
    omni = load_scenario("flat_drive", ["machine=omni"])
    assert dropped_s(omni)["drive"] == omni.driving.cmd_vel_timeout == 0.5
    config = SequenceConfig.model_validate({"steps": [VELOCITY]})
    one = SequenceRunner(config, STANDARD, RunFacts(), dropped_s(omni))
    state = one.initial_state()
    for look in range(20):
        state, _ = one.look(state, NANOSECONDS + look * NANOSECONDS * 2 // 5, SequenceInput())
    assert one.is_good(state)


def test_a_jog_whose_zeros_are_late_is_good() -> None:
    """It moved for as long as it was to: the zeros after that only ask for the arm's word that it rests."""
    one = runner(JOG)
    state = one.initial_state()
    for second in (1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 3.0, 4.0):
        now = round(second * NANOSECONDS)
        state, _ = one.look(state, now, SequenceInput({"arm": GoalReport("stopped", now)} if second > 3.0 else {}))
    assert one.is_good(state)


def test_what_only_a_person_can_let_go_on() -> None:
    one = runner({"wait_s": 1.0}, {**DRIVE, "hold": True}, DRIVE)
    run = Run(one)
    assert not one.waits_for_person(run.state)
    run.go(0.5)
    run.state = one.hold(run.state, "anna", run.now)
    assert not one.waits_for_person(run.state)  # the step under way goes on
    run.go(2.0)
    assert one.waits_for_person(run.state)
    run.state = one.resume(run.state, "anna", run.now)
    run.go(5.0)
    assert run.state.phase == "ended" and not one.waits_for_person(run.state)
    limited = Run(runner({**DRIVE, "hold": True, "within_s": 5.0}, DRIVE))
    limited.go(0.5)
    assert not limited.one.waits_for_person(limited.state)  # which fails by itself
