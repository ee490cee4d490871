"""The order of the data's flow, and the rule that holds for a field."""

from dataclasses import replace

import pytest

from sojourn_contract.flow import place_of, role_order, topic_order
from sojourn_contract.tolerance import is_angle, rule_of, text_difference, tolerance_of
from sojourn_contract.topics import TOPICS, topic


def test_a_period_passes_from_the_plant_through_sensors_power_drive_and_arm() -> None:
    assert role_order() == ("plant", "sensors", "power", "drive", "arm", "operator", "recorder")


def test_the_order_follows_from_who_waits_for_whom_and_not_from_the_rows_order() -> None:
    assert role_order(tuple(reversed(TOPICS)))[:3] == ("plant", "sensors", "power")
    # were the sensors to wait for power, power would come first
    turned = [replace(row, subscribers=("sensors",)) if row.publisher == "power" else row for row in TOPICS]
    turned = [replace(row, subscribers=()) if row.name == "/bus/state" else row for row in turned]
    assert role_order(turned)[:3] == ("plant", "power", "sensors")


def test_every_topic_comes_after_what_its_publisher_waits_for() -> None:
    order = topic_order()
    assert sorted(order) == sorted(row.name for row in TOPICS)
    for row in TOPICS:
        if row.publisher in ("plant", "all") or row.lag:
            continue
        for cause in TOPICS:
            if row.publisher in cause.subscribers and not cause.lag and not row.is_event and cause.publisher != "all":
                assert order.index(cause.name) < order.index(row.name), (cause.name, row.name)
    assert order[-1] == "/diagnostics" and place_of("/tf") > place_of("/diagnostics")


def test_a_goal_stands_just_before_the_node_that_it_is_for() -> None:
    assert place_of("/power/status") < place_of("/goal_pose") < place_of("/odom")
    assert place_of("/drive_command") < place_of("/arm/goal_pose") < place_of("/arm_command")


def test_a_rule_holds_for_all_that_is_in_its_field() -> None:
    position = rule_of("/odom", "pose.pose.position.x")
    assert position is not None and position.unit == "m"
    assert rule_of("/waypoints", "poses[3].pose.position.y") is not None
    assert rule_of("/truth/contacts", "force_y") == rule_of("/truth/contacts", "force_z")
    assert rule_of("/odom", "pose.pose.positional") is None
    assert rule_of("/odom", "header.frame_id") is None and rule_of("/tf", "transforms[0]") is None
    assert tolerance_of(None) == 0.0
    assert is_angle(rule_of("/drive_command", "position")) and not is_angle(rule_of("/drive_command", "velocity"))


def test_single_precision_in_place_of_double_is_beyond_every_tolerance_of_a_double() -> None:
    """Of values of the size that the machine has."""
    sizes = {"pose.pose.position": 3.3, "position": 1.3, "velocity": 0.3, "effort": 30.3}
    for name in ("/odom", "/drive_command", "/arm_command", "/joint_states"):
        for rule in topic(name).fields:
            size = sizes.get(rule.path)
            if size is not None:
                assert 1e-12 < tolerance_of(rule) < 2.0**-25 * size, (name, rule.path)


@pytest.mark.parametrize(
    ("one", "other", "difference", "rounding"),
    [
        ("1.234", "1.235", 0.001, 0.001),
        ("1.5e-05", "1.6e-05", 1e-6, 1e-6),
        ("4", "5", 1.0, 0.0),
        ("1.5", "1.6", 0.1, 0.0),
        ("on", "off", float("inf"), 0.0),
        ("nan", "1.0", float("inf"), 0.0),
        ("inf", "inf", float("inf"), 0.0),
    ],
)
def test_numbers_in_texts(one: str, other: str, difference: float, rounding: float) -> None:
    assert text_difference(one, other) == pytest.approx((difference, rounding))
