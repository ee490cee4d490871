"""Runs over a link: as without one where it limits nothing, held to the contract where it does, gone on with."""

from pathlib import Path

import pytest

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.run_configuration import run_configuration
from sojourn_contract.codecs import decode
from sojourn_contract.link_topics import LINK_STATUS
from sojourn_contract.topics import TOPICS
from sojourn_stack.checkpoint import load, save
from sojourn_stack.replay import app_of, replay
from sojourn_stack.run import Result, RunSpec, run
from sojourn_stack.stack import StackState

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
SHORT = ("steps=[{drive_to: {x: -0.8, y: 0.0}}]", "duration_limit_s=60.0")
FREE = "link={light_time_s: 0.0}"
NARROW = (
    "link={light_time_s: 2.5, up: {bit_s: 500.0}, down: {bit_s: 20000.0, loss: 0.1}, "
    "windows: [{kind: times, from_s: 5.0, to_s: 50.0}], "
    "telemetry: [{topic: /drive/status, priority: 1}, {topic: /odom, priority: 5}]}"
)


def record(folder: Path, *overrides: str, begin: StackState | None = None) -> tuple[Result, Bag]:
    spec = RunSpec("flat_drive", ROLES, (*SHORT, *overrides), folder, begin=begin)
    result = run(spec)
    assert result.completeness is not None and not result.completeness.gaps
    return result, read_bag(folder)


@pytest.fixture(scope="module")
def narrow(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Bag, Path]:
    """A run over a link with limits, its bag, and a checkpoint of it with a goal on the way."""
    folder = tmp_path_factory.mktemp("narrow")

    def goes_on(state: StackState) -> bool:
        link = state.roles["operator"].app.link
        if link.up.flying and not (folder / "kept").exists():
            save(state, folder / "kept")
        return True

    result = run(RunSpec("flat_drive", ROLES, (*SHORT, NARROW), folder / "bag"), goes_on)
    return result, read_bag(folder / "bag"), folder / "kept"


def test_a_link_without_limits_changes_nothing(tmp_path: Path) -> None:
    _, without = record(tmp_path / "without")
    _, free = record(tmp_path / "free", FREE)
    names = {row.name for row in TOPICS} - {"/diagnostics"}  # in which the operator tells of the link
    both = [{name: bag.topics[name] for name in bag.topics if name in names} for bag in (without, free)]
    result = compare(*both)
    # the operator acts besides when the power manager has spoken, and so two topics of a stamp may change places
    assert result.verdict in (Verdict.IDENTICAL, Verdict.WITHIN_TOLERANCE)
    assert result.matched == sum(len(messages) for messages in both[0].values())
    assert all(one.data == other.data for one, other in zip(*([b[n] for n in sorted(b)] for b in both), strict=True))
    report, _ = judge_bag(free)
    assert report.violations == 0, "\n".join(report.lines())


def test_a_goal_waits_for_its_window_and_is_carried_out(narrow: tuple[Result, Bag, Path]) -> None:
    result, bag, _ = narrow
    (goal,) = bag.topics["/goal_pose"].log_times
    # 576 bits at 500 bit/s from 2.5 s on, when what leaves arrives in the window; a light time, the next look, the lead
    assert goal == pytest.approx(1e9 * (6.2 + 0.1)) and 2.5 + 576 / 500 + 2.5 < 6.2
    (step,) = result.steps
    assert step.outcome == "reached"
    told = [decode(LINK_STATUS, data) for data in bag.topics["/link/status"].data]
    states = [status.message for message in told for status in message.status[1:]]
    assert list(dict.fromkeys(states)) == ["queued", "sent", "received"]
    (command,) = result.state.roles["operator"].app.link.log  # the run ends when the Earth knows
    assert (command.state, command.outcome) == ("executed", "reached")
    assert 1e9 * step.end_s >= command.executed + 2.5e9
    report, _ = judge_bag(bag)
    assert report.violations == 0, "\n".join(report.lines())


def test_no_telemetry_is_earlier_than_light_or_more_than_the_bandwidth(narrow: tuple[Result, Bag, Path]) -> None:
    result, bag, _ = narrow
    for name in ("/earth/drive/status", "/earth/odom"):
        messages = bag.topics[name]
        assert len(messages) > 1
        assert all(log - 1e9 * stamp >= 2.5e9 for log, stamp in zip(messages.log_times, messages.times, strict=True))
    down = result.state.roles["operator"].app.link.down
    end = result.state.now / 1e9
    assert 0.8 * 20000.0 * (end - 6.0) < down.bits_sent <= 20000.0 * (end - 5.0)


def test_the_drive_of_such_a_bag_is_replayed(narrow: tuple[Result, Bag, Path]) -> None:
    _, bag, _ = narrow
    with run_configuration(bag) as configuration:
        result = replay(bag, "drive", app_of("drive", configuration))
    assert result.comparison.verdict is Verdict.IDENTICAL


def test_a_run_goes_on_from_a_checkpoint_with_a_goal_on_the_way(
    narrow: tuple[Result, Bag, Path], tmp_path: Path
) -> None:
    result, _, kept = narrow
    state = load(kept)
    assert state.roles["operator"].app.link.up.flying
    again = run(RunSpec("flat_drive", ROLES, (*SHORT, NARROW), begin=state))
    assert again.steps == result.steps and again.state.period == result.state.period
    save(result.state, tmp_path / "one")
    save(again.state, tmp_path / "other")
    assert (
        load(tmp_path / "one").roles["operator"].app.link.up == load(tmp_path / "other").roles["operator"].app.link.up
    )
