"""The faults of a scenario: what is refused, and in which words; what whoever waits for messages is told of them."""

import re
from pathlib import Path

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.new_machine import main as new_machine
from sojourn_config.scenario import load_flight, load_scenario
from sojourn_contract.run_table import table_of

WHEEL = "wheel_front_left_joint"
EXPECTED = "topic: /drive/status, field: failed_motors, says: x, within: 5"


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("{kind: motor_dea, joint: x, at: 1}", r"faults\[0\]\.kind.*'motor_dea' is unknown.*did you mean motor_dead"),
        ("{joint: x, at: 1}", r"faults\[0\]\.kind: the key is missing"),
        ("{kind: motor_dead, joint: rocker_left_joint, at: 1}", r"faults\[0\]\.joint.*rocker_left_joint.*has no motor"),
        ("{kind: motor_dead, joint: wheel_front_let_joint, at: 1}", "did you mean wheel_front_left_joint"),
        (f"{{kind: motor_dead, joint: {WHEEL}}}", r"faults\[0\]\.at.*allowed is at, a time, or when, an event"),
        (f"{{kind: motor_dead, joint: {WHEEL}, at: -1}}", r"faults\[0\]\.at = -1: allowed is a number at least 0"),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, at: 5, until: 4}}",
            "until = 4: allowed is later than 5 s, when it comes",
        ),
        (f"{{kind: motor_dead, joint: {WHEEL}, at: 5, when: {{distance: 1}}}}", "at and when: allowed is one of them"),
        (f"{{kind: motor_dead, joint: {WHEEL}, when: {{after_step: 9}}}}", "allowed is 1 to 1"),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, when: {{later: 3}}}}",
            "no event: allowed is one of between, after_step",
        ),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, when: {{drive: movin}}}}",
            r"faults\[0\]\.when\.drive = 'movin': allowed is .*moving",
        ),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, when: {{arm: arrived}}}}",
            r"faults\[0\]\.when\.arm = 'arrived': allowed is .*reached",
        ),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, at: 1, expect: {{{EXPECTED.replace('motors', 'motor')}}}}}",
            "field 'failed_motor' is no key of /drive/status: did you mean failed_motors?",
        ),
        (
            f"{{kind: motor_dead, joint: {WHEEL}, at: 1, expect: {{{EXPECTED.replace('drive/', 'drve/')}}}}}",
            "topic '/drve/status' is no status of ours: did you mean /drive/status?",
        ),
        (f"{{kind: servo_locked, joint: {WHEEL}, at: 1, angle_deg: 20}}", "commanded by rate: allowed is no angle"),
        ("{kind: servo_locked, joint: steer_front_left_joint, at: 1, angle_deg: 120}", "limits of steer_front_left"),
        (f"{{kind: brake_stuck, joint: {WHEEL}, at: 1}}", "has no brake"),
        (f"{{kind: gear_broken, joint: {WHEEL}, at: 1, lasts: 5}}", "gear_broken does not go again"),
        ("{kind: string_lost, strings: 2, at: 1}", "allowed is fewer than the 2 that battery still has"),
        ("{kind: cell_shorted, store: spare, at: 1}", "is no battery: allowed is one of battery"),
        ("{kind: bus_short, bus: mian, resistance: 1, at: 1}", "did you mean main"),
        ("{kind: switch_stuck, load: camera, where: on, at: 1}", "did you mean cameras"),
        ("{kind: array_dust, source: solar, share: 0.5, at: 1}", "is no solar array"),
        ("{kind: soft_patch, x: 90, y: 0, radius: 1, part: 0.5, at: 1}", "is off the terrain: allowed is -10 to 10 m"),
        ("{kind: sensor, sensor: imuu, stuck: true, at: 1}", "is no sensor of the machine.*did you mean imu"),
        ("{kind: message_lost, topic: /clock, at: 1}", "holds the run together"),
        ("{kind: message_late, topic: /odom, at: 1}", r"delay: the key is missing"),
        ("{kind: message_late, topic: /odom, at: 1, delay: 0}", r"delay.*= 0.*above 0"),
        ("{kind: message_lost, topic: /odom, at: 1, probability: 0}", r"probability.*above 0"),
        ("{kind: node_silent, node: plant, at: 1}", "cannot have it: allowed is one of sensors, drive, arm, power"),
        ("{kind: node_time_jump, node: drive, by: 0.001, at: 1}", "allowed is a control period of 0.02 s or more"),
        ("{kind: node_silent, node: drive, when: {distance: 1}}", "allowed is between"),
        ("{kind: node_killed, node: operator, at: 1}", "cannot have it: allowed is one of sensors, drive, arm, power"),
        ("{kind: node_killed, node: drive, when: {distance: 1}}", "allowed is between"),
        (
            "{kind: node_killed, node: drive, when: {between: [10, 20], later: 2}, until: 12}",
            "until = 12: allowed is later than 12 s, when it comes at the earliest",
        ),
        (f"{{kind: motor_dead, joint: {WHEEL}, when: {{distance: 1, later: 9}}, until: 8}}", "later than 9 s"),
        ("{kind: node_restarted, node: drive, at: 1, lasts: 2}", "does not go again"),
        ("{kind: sensor, sensor: imu, at: 1}", "nothing is wrong by it"),
        ("{kind: sensor, sensor: imu, dead: true, when: {distance: 3}}", "allowed is a time at which that begins"),
    ],
)
def test_a_fault_that_cannot_be_is_refused(fault: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        load_scenario("flat_drive", [f"faults=[{fault}]"])


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (
            "string_lost, at: 5",
            "string_lost, at: 10",
            "strings = 1: allowed is fewer than the 1 that battery still has",
        ),
        ("cell_shorted, cells: 5, at: 5", "cell_shorted, cells: 3, at: 4", "cells = 3: allowed is fewer than the 3"),
    ],
)
def test_faults_that_cannot_be_together_are_refused(first: str, second: str, message: str) -> None:
    """Each by itself can be: the plant ended with a traceback when the second came."""
    faults = [f"{{name: a, kind: {first}}}", f"{{name: b, kind: {second}}}"]
    for fault in faults:
        load_scenario("flat_drive", [f"faults=[{fault}]"])
    with pytest.raises(ConfigError, match=rf"faults\[1\]\.{message}"):
        load_scenario("flat_drive", [f"faults=[{', '.join(faults)}]"])


def test_one_string_of_two_and_cells_besides_may_be_lost() -> None:
    load_scenario("flat_drive", ["faults=[{kind: string_lost, at: 5}, {kind: cell_shorted, cells: 7, at: 5}]"])


def test_a_panel_stands_in_some_direction() -> None:
    stuck = "faults=[{{kind: panel_stuck, source: array, normal: [0, 0, {}], at: 5}}]"
    load_scenario("flat_drive", ["machine=explorer_solar", stuck.format(-1)])
    with pytest.raises(ConfigError, match=r"faults\[0\]\.normal = \(0.0, 0.0, 0.0\): allowed is a direction"):
        load_scenario("flat_drive", ["machine=explorer_solar", stuck.format(0)])


def test_a_joint_without_a_largest_effort_seizes_with_a_torque_that_is_said(tmp_path: Path) -> None:
    new_machine(["mine", "--folder", str(tmp_path)])
    urdf = tmp_path / "mine" / "mine.urdf"
    unlimited = re.sub(
        rf'(name="{WHEEL}" type="continuous">.*?)<limit [^>]*>', r"\1", urdf.read_text("utf-8"), flags=re.S
    )
    urdf.write_text(unlimited, "utf-8")
    limits = "{max_speed: 0.2, max_yaw_rate: 0.2, max_acceleration: 0.1, max_deceleration: 0.2}"
    rates = [f"drive.mobility.{rate}_wheel_rate=2.0" for rate in ("max", "plausible")]
    given = [f"drive.limits={limits}", "drive.follower.approach_speed=0.02", *rates]
    seized = f"kind: joint_seized, joint: {WHEEL}, at: 1"
    load_scenario(str(tmp_path / "mine" / "flat.yaml"), [*given, f"faults=[{{{seized}, torque: 50}}]"])
    message = rf"faults\[0\]\.torque = null: allowed is a number: {WHEEL} has no largest effort"
    with pytest.raises(ConfigError, match=message):
        load_scenario(str(tmp_path / "mine" / "flat.yaml"), [*given, f"faults=[{{{seized}}}]"])


def test_each_fault_has_a_name_of_its_own() -> None:
    fault = f"{{kind: motor_dead, joint: {WHEEL}, at: 1}}"
    (found,) = load_scenario("flat_drive", [f"faults=[{fault}]"]).config.faults
    assert (found.called, found.at) == (f"motor_dead {WHEEL}", 1.0)
    with pytest.raises(ConfigError, match="is the name of a fault above already"):
        load_scenario("flat_drive", [f"faults=[{fault}, {fault}]"])


def test_a_fault_that_is_of_nothing_has_the_name_that_it_is_given() -> None:
    """It was ignored, so that there could be no two of them."""
    first = "{kind: soft_patch, x: 1, y: 1, radius: 0.5, part: 0.5, at: 1, name: sand trap}"
    second = "{kind: soft_patch, x: 2, y: 1, radius: 0.5, part: 0.5, at: 1}"
    found = load_scenario("flat_drive", [f"faults=[{first}, {second}]"]).config.faults
    assert [one.called for one in found] == ["sand trap", "soft_patch"]


def test_a_time_by_chance_is_that_of_the_seed() -> None:
    fault = f"{{kind: motor_dead, joint: {WHEEL}, when: {{between: [10, 20], later: 1.0}}}}"
    times = []
    for seed in (1, 1, 2, 3):
        (found,) = load_scenario("flat_drive", [f"faults=[{fault}]"]).config.faults
        times.append(found.time(seed))
    assert times[0] == times[1]
    assert len(set(times)) == 3
    assert all(11.0 <= time <= 21.0 for time in times)


def test_who_waits_for_messages_knows_when_they_are_lost() -> None:
    dead = ["faults=[{kind: sensor, sensor: hazcam, dead: true, at: 3.0}]"]
    for known in (load_scenario("flat_drive", dead), load_flight("flat_drive", dead)):
        (delivery,) = [row.delivery for row in table_of(known) if row.name == "/hazcam/points"]
        assert delivery is not None
        assert delivery.leaves(100) and not delivery.leaves(200)


def test_the_sensors_wait_for_the_operator_where_something_happens_to_them() -> None:
    for fault, waits in (("{kind: sensor, sensor: imu, stuck: true, at: 1}", True), ("", False)):
        table = table_of(load_scenario("flat_drive", [f"faults=[{fault}]"]))
        assert ("sensors" in table.topic("/operator/tick").subscribers) == waits


@pytest.mark.parametrize(
    ("topic", "field"), [("/grip/status", "jaws"), ("/drive/status", "temper"), ("/alarms", "state")]
)
def test_what_another_s_role_may_say_can_be_expected(topic: str, field: str) -> None:
    expect = f"{{topic: {topic}, field: {field}, says: x, within: 5}}"
    (found,) = load_scenario(
        "flat_drive", [f"faults=[{{kind: motor_dead, joint: {WHEEL}, at: 1, expect: {expect}}}]"]
    ).config.faults
    assert found.expect is not None and found.expect.field == field
