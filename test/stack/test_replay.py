"""A bag replayed through apps without middleware: the values of the run, and a defect is named as over topics."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sojourn_bags.comparison_result import Verdict
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.errors import ReplayError
from sojourn_bags.provenance import run_of
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.recorded_run import RecordedRun
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_bags.run_configuration import RunConfiguration, run_configuration
from sojourn_bringup.references import default_reference, references_folder
from sojourn_config.paths import ENVIRONMENT_VARIABLE
from sojourn_config.scenario import load_scenario
from sojourn_contract.run_table import table_of
from sojourn_contract.values import PoseStamped
from sojourn_machine.evolution import replace as changed
from sojourn_stack.apps import make_apps
from sojourn_stack.recorder import DirectRecorder
from sojourn_stack.replay import app_of, replay
from sojourn_stack.stack import Stack


@pytest.fixture(scope="module")
def run() -> Iterator[tuple[Bag, RunConfiguration]]:
    bag = read_bag(default_reference())
    with run_configuration(bag) as configuration:
        yield bag, configuration


@pytest.mark.parametrize("role", ROLES_TO_REPLAY)
def test_an_app_gives_the_answers_of_the_run(role: str, run: tuple[Bag, RunConfiguration]) -> None:
    bag, configuration = run
    result = replay(bag, role, app_of(role, configuration))
    assert result.comparison.verdict is not Verdict.DIFFERENT
    assert result.comparison.matched == sum(len(messages) for messages in result.script.recorded.values()) > 100


def test_a_defect_in_an_app_is_named(run: tuple[Bag, RunConfiguration]) -> None:
    bag, configuration = run
    app = app_of("power", configuration)
    step = app.step

    def halved(state: Any, period: Any) -> Any:
        state, answer = step(state, period)
        said = [
            (name, message._replace(percentage=0.5 * message.percentage) if name == "/battery_state" else message)
            for name, message in answer.messages
        ]
        return state, changed(answer, messages=said)

    app.step = halved  # type: ignore[method-assign]
    result = replay(bag, "power", app)
    assert result.comparison.verdict is Verdict.DIFFERENT
    assert [field.name for field in result.comparison.fields if field.beyond] == ["/battery_state.percentage"]


def test_what_it_hears_is_what_was_recorded(run: tuple[Bag, RunConfiguration]) -> None:
    """Each message of the bag that is due for the role, in the period in which it is due."""
    bag, configuration = run
    app, heard = app_of("power", configuration), []
    step = app.step

    def listening(state: Any, period: Any) -> Any:
        heard.append((period.stamp, period.inputs["/bus/state"].voltage))
        return step(state, period)

    app.step = listening  # type: ignore[method-assign]
    replay(bag, "power", app)
    state = bag["/bus/state"]
    recorded = dict(
        zip((1e9 * state.times).round().astype(int).tolist(), state.column("voltage").tolist(), strict=True)
    )
    assert heard and all(recorded[stamp] == voltage for stamp, voltage in heard)


def test_a_goal_sent_by_hand_of_which_nobody_tells(run: tuple[Bag, RunConfiguration]) -> None:
    """As in bags from before the heartbeats told it: nothing says under which period the role had it."""
    bag, configuration = run
    topics = {name: messages for name, messages in bag.topics.items() if name != "/operator/tick"}
    participants = run_of(bag)["participants"].replace(",operator", "")
    records = {**bag.records, RUN_RECORD: {**run_of(bag), "participants": participants}}
    by_hand = Bag(bag.path, bag.whole, topics, bag.attachments, records)
    with pytest.raises(
        ReplayError, match="a goal on /goal_pose was sent by hand, and nothing tells when drive took it"
    ):
        replay(by_hand, "drive", app_of("drive", configuration))


def test_a_goal_sent_by_hand_is_replayed_when_it_took_effect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stamped zero, as a person sends it; it is in the bag some periods from there."""
    monkeypatch.delenv(ENVIRONMENT_VARIABLE, raising=False)  # of the other tests' run
    scenario, roles = str(references_folder() / "themes" / "omni.yaml"), ("plant", "sensors", "drive", "power")
    loaded = load_scenario(scenario, ())
    apps = make_apps(loaded, roles)
    for app in apps.values():
        app.warm_up()
    stack = Stack(apps, roles, table_of(loaded))
    recorder = DirectRecorder(tmp_path / "bag", RecordedRun(scenario, (), (*roles, "recorder"), loaded=loaded))
    state, said = stack.begin()
    recorder.take(said)
    row = table_of(loaded).topic("/goal_pose")
    goal = PoseStamped(0, "map", np.array([0.3, 0.1, 0.0]), np.zeros(4))
    for period in range(1, 101):
        if period == 30:
            state = stack.hearing(state, "drive", [(row, goal)])
        if period == 37:
            recorder.take([(row, goal)])
        state, said = stack.step(state)
        recorder.take(said)
    recorder.finish()
    bag = read_bag(tmp_path)
    told = [status["took /goal_pose"] for status in bag["/diagnostics"].statuses() if "took /goal_pose" in status]
    assert told == ["600000000:0"]
    with run_configuration(bag) as configuration:
        result = replay(bag, "drive", app_of("drive", configuration))
    assert result.comparison.verdict is Verdict.IDENTICAL
    assert len(set(result.answers["/odom"].column("pose.pose.position.x").tolist())) > 10, "it drives"


def test_a_role_that_was_not_there_is_refused(run: tuple[Bag, RunConfiguration], tmp_path: Path) -> None:
    bag, _ = run
    with pytest.raises(ReplayError, match="'operator' cannot be replayed"):
        replay(bag, "operator", None)  # type: ignore[arg-type]
