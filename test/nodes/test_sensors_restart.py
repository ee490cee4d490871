"""Sensors whose process was started again: what was wrong with them still is, and the parts know what they knew."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App, Period
from sojourn_contract.disturbed_app import disturbed, undisturbed
from sojourn_contract.fault_messages import FaultEvent, fault_message
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import status_message
from sojourn_contract.kept_data import KEEP_EVERY_NS, Kept
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.state_tree import packed, unpacked
from sojourn_contract.values import Odometry
from sojourn_machine.disturbance import Disturbance
from sojourn_machine.rotations import quaternion_of
from sojourn_machine.sensor_fault import SensorFault
from sojourn_physics.sensors.resistance_thermometer import ERRORS
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.memory import SensorsState
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.plain import like, plain
from sojourn_sensors.supply import LOADS

BIAS = SensorFault.model_validate({"sensor": "imu", "of": "angular_velocity", "bias": 0.5, "drift": 0.1, "at": 0.0})
STUCK = SensorFault.model_validate({"sensor": "imu", "stuck": True, "at": 0.0})
DUST = SensorFault.model_validate({"sensor": "hazcam", "dust": 0.7, "at": 0.0})
RATE = 0.3
"""At which the machine turns [rad/s]."""
BEFORE, AFTER = 40, 60
"""Control periods: of the restart, and of the end."""


def app_of(*told: str) -> SensorsApp:
    return SensorsApp(load_scenario("flat_drive", ["steps=[]", *told]))


@pytest.fixture(scope="module")
def app() -> SensorsApp:
    return app_of("sensors.powered_by={imu: imu}")


def among(app: SensorsApp, *ends: Disturbance) -> App[Any]:
    return disturbed(app, table_of(load_scenario("flat_drive")), list(ends))


RESTARTED = Disturbance("restarted", "", "sensors", BEFORE * CONTROL_PERIOD_NS)


def truth_at(app: SensorsApp, number: int, power: float = 5.0) -> dict[str, Any]:
    """Of a machine that turns on the spot, its IMU with so much power [W]."""
    truth, stamp = app._at_rest(), number * CONTROL_PERIOD_NS
    angle = RATE * stamp / NANOSECONDS
    turned = np.array([0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)])
    odometry = Odometry(stamp, "map", "base_link", np.zeros(3), turned, np.zeros(3), np.array([0.0, 0.0, RATE]))
    inputs = {**truth.inputs, "/truth/odom": odometry, "/truth/joint_states": truth.joints}
    return inputs | ({LOADS: status_message(stamp, "loads", {"power imu": str(power)})} if number % 5 == 0 else {})


def stepped(
    app: SensorsApp, among: App[Any], state: Any, periods: Sequence[int], faults: dict[int, list[FaultEvent]]
) -> Iterator[tuple[Any, dict[str, Any]]]:
    """State and messages of each period, with the faults that come or go in some."""
    for number in periods:
        stamp = number * CONTROL_PERIOD_NS
        goals = [(FAULTS_TOPIC, fault_message(stamp, event)) for event in faults.get(number, ())]
        state, answer = among.step(state, Period(stamp, truth_at(app, number), goals))
        yield state, dict(answer.messages)


def rate_said(said: dict[str, Any]) -> float:
    return float(said["/imu/data"].angular_velocity[2])


def kept_of(app: SensorsApp, state: SensorsState, number: int = BEFORE) -> Kept:
    return Kept(number * CONTROL_PERIOD_NS, json.loads(json.dumps(app.to_keep(state))))


def after(app: SensorsApp, periods: int, *faults: SensorFault) -> SensorsState:
    """With faults since period 3, named by their sensors."""
    events = {3: [FaultEvent(f"{fault.sensor} {place}", fault, True) for place, fault in enumerate(faults)]}
    *_, (state, _) = stepped(app, app, app.initial_state(), range(1, periods + 1), events)
    return undisturbed(state)


@pytest.mark.parametrize("end", [RESTARTED, Disturbance("killed", "", "sensors", 30 * CONTROL_PERIOD_NS, RESTARTED[3])])
def test_a_restart_repairs_no_sensor(app: SensorsApp, end: Disturbance) -> None:
    faults = {3: [FaultEvent("gyro", BIAS, True)], 4: [FaultEvent("lens", DUST, True)]}
    disturbed_app = among(app, end)
    for number, (state, said) in enumerate(
        stepped(app, disturbed_app, disturbed_app.initial_state(), range(1, AFTER), faults), start=1
    ):
        stamp = number * CONTROL_PERIOD_NS
        if number < 4:
            continue
        off = 0.5 + 0.1 * (number - 3) * CONTROL_PERIOD_NS / NANOSECONDS
        assert rate_said(said) - RATE == pytest.approx(off, abs=2e-3), "its drift goes on from when it came"
        told = disturbed_app.heartbeat_values(state, stamp)
        alarm = {"alarm": "the sensors were restarted"} if number >= BEFORE else {}
        assert told == {"faults": "gyro, lens"} | alarm
    assert state.restarts == 1


def test_a_fault_that_went_before_a_restart_stays_away_and_one_may_go_after_it(app: SensorsApp) -> None:
    faults = {
        3: [FaultEvent("gyro", BIAS, True), FaultEvent("lens", DUST, True)],
        20: [FaultEvent("lens", DUST, False)],
        50: [FaultEvent("gyro", BIAS, False)],
    }
    among_it = among(app, RESTARTED)
    told = [
        among_it.heartbeat_values(state, 0).get("faults", "")
        for state, _ in stepped(app, among_it, among_it.initial_state(), range(1, AFTER), faults)
    ]
    assert told[BEFORE:49] == ["gyro"] * (49 - BEFORE) and told[49:] == [""] * (AFTER - 50)


def test_a_fault_of_a_table_that_was_ended_does_not_come_back() -> None:
    app = app_of("sensors.imu.faults={gyro: {of: angular_velocity, bias: 0.5}}")
    *_, (state, _) = stepped(app, app, app.initial_state(), range(1, 9), {5: [FaultEvent("gyro", BIAS, False)]})
    again = app.started_again(app.initial_state(), BEFORE * CONTROL_PERIOD_NS, kept_of(app, state))
    assert app.initial_state().faulty and not again.faulty


def test_a_sensor_that_is_stuck_repeats_after_a_restart_what_it_repeated_before(app: SensorsApp) -> None:
    among_it, said = among(app, RESTARTED), list[float]()
    for _, messages in stepped(
        app, among_it, among_it.initial_state(), range(1, AFTER), {10: [FaultEvent("a", STUCK, True)]}
    ):
        said.append(rate_said(messages))
    assert said[9:] == [said[8]] * (AFTER - 10) and len(set(said[:9])) > 3


def test_what_has_no_power_has_none_after_a_restart(app: SensorsApp) -> None:
    *_, (state, _) = stepped(app, app, app.initial_state(), range(1, 6), {})
    state, _ = app.step(state, Period(10 * CONTROL_PERIOD_NS, truth_at(app, 10, power=0.0)))
    again = app.started_again(app.initial_state(), 11 * CONTROL_PERIOD_NS, kept_of(app, state, 10))
    _, answer = app.step(again, Period(11 * CONTROL_PERIOD_NS, truth_at(app, 11)))
    assert np.isnan(dict(answer.messages)["/imu/data"].angular_velocity).all()


def test_an_imu_does_not_find_its_heading_again(app: SensorsApp) -> None:
    """It was set to the true one, and its slow errors began anew."""
    app = app_of(
        "sensors.imu={extends: stim300, gyro_bias_deg_per_hour: 1.0e4, attitude_gain: 0.01, attitude_gate: 0.1}"
    )
    place = [sensor.name for sensor in app.sensors].index("imu")

    def heading_error(state: SensorsState, number: int) -> float:
        truth = rotation_matrix(truth_at(app, number)["/truth/odom"].orientation)
        off = rotation_matrix(state.readings[place].orientation) @ truth.T
        return float(2.0 * np.arctan2(*quaternion_of(off)[2:]))

    before = after(app, BEFORE)
    start = after(app, 1)
    grown = heading_error(before, BEFORE) - heading_error(start, 1)
    gap = 10
    again = app.started_again(app.initial_state(), (BEFORE + gap) * CONTROL_PERIOD_NS, kept_of(app, before))
    again, _ = app.step(again, Period((BEFORE + gap) * CONTROL_PERIOD_NS, truth_at(app, BEFORE + gap)))
    going_on = heading_error(again, BEFORE + gap) - heading_error(before, BEFORE)
    assert abs(grown) > 5e-4 and going_on == pytest.approx(grown * gap / (BEFORE - 1), rel=0.3)
    errors = again.sensors[place].imu
    assert errors.elapsed == pytest.approx((BEFORE + gap) * 0.02 + app.sensors[place].params.alignment_time)


PARTS = (
    "sensors.joint_groups.suspension.encoder={kind: incremental_encoder, side: output, lines: 500, zero_error: 0.2}",
    "sensors.joint_groups.steer.encoder={kind: tachometer, side: output, resolution: 1.0e-3, offset_error: 0.1}",
    "sensors.torque={kind: torque_sensor, joints: [arm_elbow_joint], rated_torque: 60.0, zero_error: 0.0, noise: 0.0}",
    "sensors.ends={kind: limit_switches, joints: [arm_elbow_joint], before: 0.02, hysteresis: 0.01}",
    "sensors.cells={extends: pt100, store: battery}",
)


@pytest.fixture(scope="module")
def parts() -> SensorsApp:
    return app_of(*PARTS)


@pytest.mark.parametrize("name", ["imu", "joint_groups", "torque", "ends", "cells"])
def test_what_a_part_remembers_goes_through_json_to_the_last_bit(parts: SensorsApp, name: str) -> None:
    place = [sensor.name for sensor in parts.sensors].index(name)
    sensor, before = parts.sensors[place], after(parts, 55).sensors
    assert before is not None
    remembered = sensor.hardware(before[place])
    read = like(remembered, json.loads(json.dumps(plain(remembered))))
    assert plain(read) == plain(remembered) != None  # noqa: E711
    first = sensor.initial_state(parts._at_rest())
    assert plain(sensor.hardware(sensor.with_hardware(first, read))) == plain(remembered)


def test_angles_that_are_counted_go_on_where_they_were(parts: SensorsApp) -> None:
    """A zero that is not known stays the same, and a sum of rates goes on."""
    before, place = after(parts, 200), [sensor.name for sensor in parts.sensors].index("joint_groups")
    number = 210
    again = parts.started_again(parts.initial_state(), number * CONTROL_PERIOD_NS, kept_of(parts, before, 200))
    again, _ = parts.step(again, Period(number * CONTROL_PERIOD_NS, truth_at(parts, number)))
    (names, told), (_, was) = again.readings[place], before.readings[place]
    of = {name: at for at, name in enumerate(names)}
    rocker, steer = of["rocker_left_joint"], of["steer_front_left_joint"]
    assert told.position[rocker] == was.position[rocker] != 0.0 and told.velocity[rocker] == 0.0
    drift = told.velocity[steer] * 0.02 * (number - 200)
    assert told.position[steer] - was.position[steer] == pytest.approx(drift) and abs(was.position[steer]) > 0.01


def test_a_thermometer_is_as_warm_as_it_was(parts: SensorsApp) -> None:
    place = [sensor.name for sensor in parts.sensors].index("cells")
    sensor = parts.sensors[place]
    first = sensor.initial_state(parts._at_rest())
    warmed = sensor.with_hardware(first, 250.0)
    assert warmed.thermometer.element == 250.0 and warmed.thermometer.errors.shape == (ERRORS,)
    with pytest.raises(ValueError):
        sensor.with_hardware(first, -3.0)


@pytest.mark.parametrize("end", [BEFORE - 1, BEFORE, BEFORE + 1, BEFORE + 2, BEFORE + 3])
def test_nobody_waits_for_ever_for_what_was_on_its_way(end: int) -> None:
    """In lock-step others wait for each message that the run's table has, also for those measured before a restart."""
    app = app_of("sensors.imu.timing={rate: 12.5, latency: 0.1, jitter: 0.03}")
    (delivery,) = [row.delivery for sensor in app.sensors if sensor.name == "imu" for row in sensor.rows]
    assert delivery is not None
    restart = RESTARTED._replace(begin=end * CONTROL_PERIOD_NS)
    among_it = among(app, restart)
    for number, (_, said) in enumerate(stepped(app, among_it, among_it.initial_state(), range(1, AFTER), {}), start=1):
        due = [measured * CONTROL_PERIOD_NS for measured in delivery.left_at(number)]
        assert ([said["/imu/data"].stamp] if "/imu/data" in said else []) == due[-1:]


def test_without_anything_kept_it_says_so(app: SensorsApp) -> None:
    again = app.started_again(app.initial_state(), BEFORE * CONTROL_PERIOD_NS, None)
    alarm = "the sensors were restarted; not known any more: what is wrong with them, what they remember"
    assert app.heartbeat_values(again, 0) == {"alarm": alarm}
    assert app.heartbeat_values(app.initial_state(), 0) == {}


GOOD = ["hazcam", "lens", {"dust": 0.7}]


@pytest.mark.parametrize(
    ("spoilt", "words", "known"),
    [
        ({"faults": None}, "fault null", []),
        ({"faults": 7}, "fault 7", []),
        ({"faults": [GOOD, ["nobody", "a", {"dust": 0.7}]]}, "fault ['nobody'", ["lens"]),
        ({"faults": [GOOD, ["imu", "a", {"dust": 0.7}]]}, "fault ['imu', 'a'", ["lens"]),
        ({"faults": [GOOD, ["imu", "a", {"of": "angular_velocity", "bias": float("nan")}]]}, "fault", ["lens"]),
        ({"faults": [GOOD, ["imu", 3, {"stuck": True}], [[], "b", {"stuck": True}], ["imu"]]}, "fault", ["lens"]),
        ({"faults": [["imu", "a", {"dead": True}], GOOD]}, "fault", ["lens"]),
        ({"hardware": None}, "what they remember", ["imu 0", "hazcam 1"]),
        ({"hardware": {"imu": [1.0]}}, "what imu remembers", ["imu 0", "hazcam 1"]),
        ({"hardware": {"imu": 7}}, "what imu remembers", ["imu 0", "hazcam 1"]),
        ({"repeated": {"imu": {"a": "b"}}}, "what imu remembers", ["imu 0", "hazcam 1"]),
        ({"dead": 3, "measured_at": "now"}, "", ["imu 0", "hazcam 1"]),
    ],
)
def test_what_cannot_be_read_is_left_out_and_said(
    app: SensorsApp, spoilt: dict[str, Any], words: str, known: list[str]
) -> None:
    before = after(app, BEFORE, STUCK, DUST)
    kept = kept_of(app, before)
    again = app.started_again(app.initial_state(), (BEFORE + 1) * CONTROL_PERIOD_NS, Kept(1, {**kept.values, **spoilt}))
    (again, said), *_ = stepped(app, app, again, [BEFORE + 1], {})
    told = app.heartbeat_values(again, 0)
    assert words in told["alarm"] and ("not known any more" in told["alarm"]) == bool(words)
    assert [name for one in again.faulty.values() for name, _ in one.faults] == known
    assert np.isfinite(rate_said(said))


def test_a_state_after_a_restart_is_saved_and_resumed(app: SensorsApp) -> None:
    again = app.started_again(app.initial_state(), BEFORE * CONTROL_PERIOD_NS, kept_of(app, after(app, 30, BIAS)))
    for steps in (0, 3):
        state = again
        for number in range(BEFORE, BEFORE + steps):
            state, _ = app.step(state, Period(number * CONTROL_PERIOD_NS, truth_at(app, number)))
        read = unpacked(packed(state, "sensors"), "sensors")
        number = BEFORE + steps
        said = [
            dict(app.step(each, Period(number * CONTROL_PERIOD_NS, truth_at(app, number)))[1].messages)
            for each in (state, read)
        ]
        assert plain(tuple(said[0]["/imu/data"])) == plain(tuple(said[1]["/imu/data"]))
        assert read.restart == state.restart


def test_keeping_takes_no_time_to_speak_of(app: SensorsApp) -> None:
    """It is asked for in every period, and written every fifth of a second."""
    values = app.to_keep(after(app, 50, STUCK, DUST))
    assert len(json.dumps(values)) < 20_000 and KEEP_EVERY_NS > CONTROL_PERIOD_NS
