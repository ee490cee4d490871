"""The rows that a link brings, and that a run without one has none of them."""

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_flight, load_scenario
from sojourn_contract.errors import LinkError
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.link_topics import CANCEL, LINK_STATUS
from sojourn_contract.run_table import row_named, table_of
from sojourn_operator.scenario_steps import prepare_scenario

LINK = "link={light_time_s: 1.3}"


def test_a_run_without_a_link_has_the_table_that_it_had() -> None:
    table = table_of(load_scenario("flat_drive"))
    assert LINK_STATUS.name not in table and not any(row.name.startswith("/earth") for row in table)
    assert "operator" not in table.topic("/power/status").subscribers


def test_a_link_asks_nothing_of_the_machine() -> None:
    """Rows that its roles publish or hear stay as they are, but that the operator listens besides."""
    without, table = table_of(load_scenario("flat_drive")), table_of(load_scenario("flat_drive", [LINK]))
    machine = ("plant", "sensors", "drive", "arm", "power")
    for role in machine:
        assert [row.name for row in table.inputs_of(role)] == [row.name for row in without.inputs_of(role)]
        assert [row.name for row in table.outputs_of(role)] == [row.name for row in without.outputs_of(role)]
    assert "operator" in table.topic("/power/status").subscribers


def test_truth_and_belief_have_the_same_table() -> None:
    overrides = ["link={light_time_s: 1.3, telemetry: [{topic: /odom}]}"]
    known, true = (table_of(load("flat_drive", overrides)) for load in (load_flight, load_scenario))
    assert known.rows == true.rows
    assert "/earth/odom" in known and "/earth/drive/status" not in known


def test_every_row_of_a_run_with_a_link_is_known_by_its_name() -> None:
    table = table_of(load_scenario("flat_drive", [LINK]))
    brought = [row for row in table if row.name.startswith("/earth") or row.name == LINK_STATUS.name]
    assert {CANCEL.name, "/earth/goal_pose", "/earth/arm/stop", "/earth/battery_state"} <= {row.name for row in brought}
    assert len(brought) == len(GOAL_TOPICS) - 1 + 4 + 2  # all goals but faults, the statuses, and its own two
    for row in brought:
        assert row_named(row.name) == row
    assert row_named("/earth/nothing") is None


@pytest.mark.parametrize("topic", ["/no/such", "/goal_pose", "/diagnostics", "/clock", "/truth/odom"])
def test_telemetry_that_no_run_can_carry_is_told_with_what_it_can(topic: str) -> None:
    overrides = [f"link={{light_time_s: 0, telemetry: [{{topic: /odom}}, {{topic: {topic}}}]}}"]
    with pytest.raises(LinkError, match=r"link\.telemetry\.1\.topic"):
        table_of(load_scenario("flat_drive", overrides))
    with pytest.raises(ConfigError, match=topic):
        prepare_scenario("flat_drive", overrides)


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("{}", "light_time_s"),
        ("{light_time_s: 1, windows: [{kind: earth}]}", "a site and a date"),
        ("{light_time_s: -1}", "light_time_s"),
        ("{light_time_s: 1, up: {bit_s: 0}}", "bit_s"),
        ("{light_time_s: 1, windows: [{kind: times, from_s: 9, to_s: 3}]}", "later than from_s"),
    ],
)
def test_a_link_that_cannot_be_is_refused_before_a_run(link: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        prepare_scenario("flat_drive", [f"link={link}"])
