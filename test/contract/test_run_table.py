"""The table of a run: rows for each thing of its machine, found again by their names alone."""

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.description import contract_data, row_of_data
from sojourn_contract.errors import SensorRowError, TopicNameError, UnknownTopicError
from sojourn_contract.flow import place_of
from sojourn_contract.run_table import STORE, row_named, rows_of, table_of
from sojourn_contract.tolerance import rule_of
from sojourn_contract.topic_table import TopicTable, of_thing
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, STANDARD, TOPICS, topic
from sojourn_machine.sensor_choice import SensorParams

PER_STORE = ("/truth/electrical", "/bus/state", "/battery_state")
NAMES = st.lists(st.from_regex(r"[a-z_][a-z0-9_]{0,8}", fullmatch=True), min_size=1, max_size=5, unique=True)


def test_a_machine_with_one_thing_of_each_kind_has_the_standard_table() -> None:
    assert table_of(load_scenario("flat_drive")).rows == STANDARD.rows == TOPICS
    assert tuple(row.name for row in TOPICS if row.each == STORE) == PER_STORE


@given(NAMES)
def test_rows_of_further_things_follow_the_first_and_are_found_by_name(names: list[str]) -> None:
    table = STANDARD.for_things({STORE: names})
    assert len(table) == len(TOPICS) + len(PER_STORE) * (len(names) - 1)
    assert [row for row in table if not row.thing] == list(TOPICS)
    for first in PER_STORE:
        rows = table.each(first)
        assert [row.name for row in rows] == [first, *(f"{first}/{name}" for name in names[1:])]
        place = table.rows.index(rows[0])
        assert table.rows[place : place + len(rows)] == rows
        for row in rows:
            assert row_named(row.name) == row and table.topic(row.name) is row
            assert place_of(row.name) == place_of(first)
            assert rule_of(row.name, "voltage") == rule_of(first, "voltage") is not None


@given(NAMES)
def test_who_acts_on_the_first_acts_on_all(names: list[str]) -> None:
    table = STANDARD.for_things({STORE: names})
    for role in ROLES:
        awaited = {row.name for row in awaited_inputs(role, ROLES, table)}
        for first in PER_STORE:
            alike = {row.name for row in table.each(first)}
            assert alike <= awaited or alike.isdisjoint(awaited)
            assert (first in awaited) == (first in {row.name for row in awaited_inputs(role, ROLES)})


@pytest.mark.parametrize("names", [("a", "b", "b"), ("a", "2b"), ("a", "b c"), ("a", ""), ("a", "b/"), ("a", "ü")])
def test_a_name_that_no_topic_can_have_is_refused(names: tuple[str, ...]) -> None:
    with pytest.raises(TopicNameError, match="topic"):
        STANDARD.for_things({STORE: names})


@pytest.mark.parametrize("name", ["/tf", "/odom/spare", "/bus/state/", "bus/state", "/bus", "", "/"])
def test_a_topic_that_no_run_has_is_found_by_no_name(name: str) -> None:
    assert row_named(name) is None
    assert rule_of(name, "voltage") is None
    assert place_of(name) > max(place_of(row.name) for row in TOPICS)


def test_a_row_of_a_further_thing_is_no_other_topic() -> None:
    with pytest.raises(UnknownTopicError):
        STANDARD.topic("/bus/state/spare")
    assert "/bus/state/spare" not in STANDARD and STANDARD.get("/bus/state/spare") is None
    with pytest.raises(TopicNameError, match="once"):
        STANDARD.joined_with([topic("/odom")])


def test_what_a_machine_brings_stands_behind_the_last_of_its_publisher() -> None:
    brought = Topic("/ranger/range", "sensor_msgs/Range", "sensors", (), 1, 0.1, "distance")
    table = STANDARD.joined_with([brought, of_thing(topic("/bus/state"), "spare")])
    names = [row.name for row in table]
    assert names[names.index("/hazcam/points") + 1] == "/ranger/range"
    assert names[names.index("/bus/state") + 1] == "/bus/state/spare"


@pytest.mark.parametrize("row", TOPICS, ids=lambda row: row.name)
def test_a_row_can_be_read_again_from_its_description(row: Topic) -> None:
    data = contract_data([row])["topics"][row.name]
    again = row_of_data(row.name, data)
    assert contract_data([again]) == contract_data([row])
    assert again.type == row.type and again.every == row.every and again.reliability is row.reliability


REAR = (
    "sensors.sun_rear={kind: sun, link: solar_deck_link, field_of_view_deg: 9.0, noise_deg: 0.1, misalignment_deg: 0.1}"
)


def test_a_further_sensor_of_a_kind_has_a_row_of_its_own() -> None:
    table = table_of(load_scenario("flat_drive", [REAR]))
    assert [row.name for row in table.each("/sun_direction")] == ["/sun_direction", "/sun_direction/sun_rear"]
    assert len(table) == len(TOPICS) + 1


class Brought(SensorParams):
    """A kind of sensor from elsewhere."""

    kind: str = "brought"


@pytest.mark.parametrize(
    ("change", "allowed"),
    [
        ({"publisher": "plant"}, "role sensors"),
        ({"every": 0}, "with a rate"),
        ({"logged": False}, "logged"),
        ({"name": "/imu/data"}, "name that no topic"),
    ],
)
def test_a_row_that_no_sensor_can_have_is_refused(change: dict[str, Any], allowed: str) -> None:
    row = Topic("/ranger/range", "sensor_msgs/Range", "sensors", (), 1, 0.1, "distance")
    Brought.speaks_on = (row, topic("/imu/data"))
    assert [each.each for each in rows_of(Brought)] == ["/ranger/range", "imu"]
    Brought.speaks_on = (replace(row, **change),)
    with pytest.raises(SensorRowError, match=allowed):
        list(rows_of(Brought))


LIDAR = "link: hazcam_link, columns: 9, rows: 4, horizontal_view_deg: 9, vertical_view_deg: 5, nearest: 0.1, range: 9"
CAMERA = "kind: camera, link: hazcam_link, lens: {columns: 32, rows: 24, horizontal_view_deg: 60}"
SWITCH = "kind: bump_switch, link: hazcam_link, width: 0.6, height: 0.1, travel: 0.05"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            [f"sensors.hazcam={{kind: lidar, {LIDAR}, noise: 0.01}}"],
            r"hazcam: would speak on /hazcam/points, .*every run",
        ),
        (
            [f"sensors.bump={{{CAMERA}}}", f"sensors.image={{{SWITCH}}}"],
            "image: would speak on /bump/image, a topic of the sensor bump",
        ),
    ],
)
def test_a_sensor_by_whose_name_a_topic_would_be_there_twice_is_refused(changes: list[str], words: str) -> None:
    """With its file, as other mistakes of the configuration."""
    loaded = load_scenario("flat_drive", changes)
    with pytest.raises(ConfigError, match=rf"sensors\.yaml.*{words}"):
        table_of(loaded)


def test_the_digest_tells_tables_apart() -> None:
    def digest(table: TopicTable) -> Any:
        return contract_data(table)["digest"]

    assert digest(STANDARD) == contract_data()["digest"]
    assert digest(STANDARD.for_things({STORE: ("a", "b")})) != digest(STANDARD)


@given(NAMES)
def test_a_row_that_names_all_stands_for_none_without_a_name(names: list[str]) -> None:
    row = Topic("/heat", "sensor_msgs/Temperature", "sensors", (), 50, 3.0, "of a part", each="/heat", all_named=True)
    table = STANDARD.joined_with([row]).for_things({"/heat": names})
    brought = [each for each in table if each.name.startswith("/heat")]
    assert [each.name for each in brought] == [f"/heat/{name}" for name in names]
    assert [each.thing for each in brought] == names
    assert "/heat" not in table and len(table) == len(TOPICS) + len(names)
