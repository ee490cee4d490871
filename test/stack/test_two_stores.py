"""A machine with two energy stores: the rows that stand once for each are in its runs, its bags and their verdicts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.contract_version import check_contract, table_of_bag
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import read_bag
from sojourn_bags.replay_script import script_of
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract import run_table
from sojourn_contract.app import Answer, App, Period
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.page import contract_page
from sojourn_contract.topic_types import Topic
from sojourn_sensors.kinds import bus
from sojourn_stack import run as direct
from sojourn_stack.apps import make_apps

ROLES = ("plant", "sensors", "drive", "power", "operator", "recorder")
SHORT = ("steps=[{wait_s: 2.0}]",)
FURTHER = ("/truth/electrical/spare", "/bus/state/spare", "/battery_state/spare")


@dataclass(frozen=True)
class Doubled:
    """An app that says of the store `spare` what it says of the first."""

    app: App[Any]

    def __getattr__(self, name: str) -> Any:
        return getattr(self.app, name)

    def check(self, row: Topic, message: Any) -> None:
        self.app.check(row, message)

    def first_messages(self, state: Any, stamp: int) -> list[tuple[str, Any]]:
        return _doubled(self.app.first_messages(state, stamp))

    def step(self, state: Any, period: Period) -> tuple[Any, Answer]:
        for name in FURTHER:
            first = name.removesuffix("/spare")
            assert (name in period.inputs) == (first in period.inputs)
        state, answer = self.app.step(state, period)
        return state, Answer(_doubled(answer.messages), answer.refusals, answer.errors, answer.finished)


def _doubled(messages: Any) -> list[tuple[str, Any]]:
    said = []
    for name, message in messages:
        said.append((name, message))
        if f"{name}/spare" in FURTHER:
            said.append((f"{name}/spare", message))
    return said


def add_a_store(patched: pytest.MonkeyPatch) -> None:
    """To every machine."""
    things_of = run_table.things_of

    def with_spare(scenario: LoadedScenario) -> Mapping[str, tuple[str, ...]]:
        return {**things_of(scenario), run_table.STORE: ("battery", "spare")}

    for module in (run_table, bus):
        patched.setattr(module, "things_of", with_spare)


@pytest.fixture
def two_stores(monkeypatch: pytest.MonkeyPatch) -> None:
    add_a_store(monkeypatch)

    def doubled(scenario: Any, roles: Sequence[str]) -> Mapping[str, Any]:
        apps = make_apps(scenario, roles)  # the sensors measure each store that there is
        return {role: app if role == "sensors" else Doubled(app) for role, app in apps.items()}

    monkeypatch.setattr(direct, "make_apps", doubled)


@pytest.mark.usefixtures("two_stores")
def test_a_run_of_two_stores_is_recorded_judged_and_compared(tmp_path: Path) -> None:
    bags = []
    for name in ("one", "other"):
        spec = direct.RunSpec("flat_drive", ROLES, SHORT, bag=tmp_path / name)
        result = direct.run(spec)
        assert result.completeness is not None and not result.completeness.gaps
        # the recorder waits for the further rows as for the first ones
        counts = result.completeness.counts
        for topic in FURTHER:
            assert counts[topic] == counts[topic.removesuffix("/spare")] and counts[topic].due
        bags.append(read_bag(tmp_path / name))
    one, other = bags
    assert set(FURTHER) <= set(one.topics)
    check_contract(one)
    report, _ = judge_bag(one)
    assert report.violations == 0 and set(FURTHER) <= set(report.messages)
    assert compare(one.topics, other.topics).verdict is Verdict.IDENTICAL
    assert [row.name for row in script_of(one, "sensors").inputs if row.thing] == ["/truth/electrical/spare"]
    assert set(script_of(one, "power").due) >= {"/battery_state", "/battery_state/spare"}

    del other.topics["/bus/state/spare"]
    found, _ = judge_bag(other)
    assert {group.topic for group in found.groups if group.rule == "answer"} == {"/bus/state/spare"}


@pytest.mark.usefixtures("two_stores")
def test_the_contract_shows_what_the_machine_of_a_run_has() -> None:
    machine = JudgedMachine.of_scenario(load_scenario("flat_drive"))
    page = contract_page(machine)
    assert all(name in machine.table and name in page for name in FURTHER)


def test_a_bag_says_itself_which_stores_its_machine_had(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    with pytest.MonkeyPatch.context() as patched:
        add_a_store(patched)
        spec = direct.RunSpec("flat_drive", ROLES, SHORT, bag=tmp_path / "bag")
        direct.run(spec, lambda state: state.period <= 1)
    bag = read_bag(tmp_path / "bag")
    assert set(FURTHER) <= {row.name for row in table_of_bag(bag)}
