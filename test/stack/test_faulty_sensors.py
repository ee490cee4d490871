"""Faults of sensors on a whole run: nobody else's numbers change, no number that is none enters the odometry, and what
is silent or of no use is told in words.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.absence import PATIENCE_S
from sojourn_contract.clouds import points_of
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_values
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.values import Message
from sojourn_machine.evolution import replace
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_sensors.app import SensorsState
from sojourn_sensors.fault_hooks import FaultyState
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Stack, StackState

OPEN = ("plant", "sensors")
"""Nobody acts on what is measured: the truth is the same whatever that is."""
CLOSED = ("plant", "sensors", "drive", "power", "operator")
MEASURED = ("/imu/data", "/joint_states", "/bus/state", "/sun_direction", "/hazcam/points")
GYRO = "sensors.imu.faults={gyro: {of: angular_velocity, "
Said = dict[str, list[Message]]


def stack_of(told: Sequence[str], roles: Sequence[str]) -> Stack:
    scenario = load_scenario("flat_drive", told)
    return Stack(make_apps(scenario, roles), roles, table_of(scenario))


def gone_on(stack: Stack, state: StackState, periods: int) -> tuple[StackState, Said]:
    """The state after some periods, or at the run's end, and what was said in them, by topic."""
    told: Said = {}
    for _ in range(periods):
        if state.finished:
            break
        state, said = stack.step(state)
        for row, message in said:
            told.setdefault(row.name, []).append(message)
    return state, told


def said_in(told: Sequence[str], roles: Sequence[str] = OPEN, periods: int = 110) -> Said:
    stack = stack_of(told, roles)
    return gone_on(stack, stack.begin()[0], periods)[1]


def as_bytes(stack_table: Any, name: str, messages: list[Message]) -> list[bytes]:
    return [encode(stack_table.topic(name), message) for message in messages]


@pytest.fixture(scope="module")
def sound() -> Said:
    return said_in([])


@pytest.mark.parametrize(
    ("told", "of"),
    [
        (GYRO + "bias: 0.01, spike_probability: 0.2, spike_size: 1.0}}", "/imu/data"),
        ("sensors.joint_faults={all: {of: position, scale: -1.0, after: 0.5}}", "/joint_states"),
        ("sensors.bus.faults={a: {stuck: true}, b: {dropout: 0.5}}", "/bus/state"),
        ("sensors.hazcam.faults={a: {dead: true, after: 1.5}}", "/hazcam/points"),
        ("sensors.imu.timing={latency: 0.1, jitter: 0.1, dropped: 0.3}", "/imu/data"),
        ("sensors.bus.timing={rate: 2.0, latency: 0.13}", "/bus/state"),
    ],
)
def test_no_other_sensor_says_anything_else(sound: Said, told: str, of: str) -> None:
    table, faulty = table_of(load_scenario("flat_drive")), said_in([told])
    for name in MEASURED:
        same = as_bytes(table, name, sound[name]) == as_bytes(table, name, faulty[name])
        assert same == (name != of), name


def test_what_is_only_late_says_the_same_later(sound: Said) -> None:
    table = table_of(load_scenario("flat_drive"))
    late = said_in(["sensors.imu.timing={latency: 0.1, jitter: 0.1, dropped: 0.3}"])["/imu/data"]
    expected = dict(
        zip((m.stamp for m in sound["/imu/data"]), as_bytes(table, "/imu/data", sound["/imu/data"]), strict=True)
    )
    assert 40 < len(late) < 100
    assert [m.stamp for m in late] == sorted({m.stamp for m in late})
    assert all(expected[m.stamp] == told for m, told in zip(late, as_bytes(table, "/imu/data", late), strict=True))


def test_the_fault_is_what_was_asked_for(sound: Said) -> None:
    told = GYRO + "scale: 2.0, bias: [0.0, 0.1, 0.0], drift: 0.5, after: 1.0}}"
    for before, now in zip(sound["/imu/data"], said_in([told])["/imu/data"], strict=True):
        time = before.stamp * 1e-9 - 1.0
        expected = (
            before.angular_velocity if time < 0.0 else 2.0 * before.angular_velocity + [0.0, 0.1, 0.0] + 0.5 * time
        )
        np.testing.assert_allclose(now.angular_velocity, expected, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(now.orientation, before.orientation)


def test_dust_hides_its_share_and_nothing_but_that(sound: Said) -> None:
    said = said_in(["sensors.hazcam.faults={lens: {dust: 0.3}}"])["/hazcam/points"]
    for before, now in zip(sound["/hazcam/points"], said, strict=True):
        whole, left = (points_of("/hazcam/points", message) for message in (before, now))
        assert {tuple(point) for point in left.tolist()} < {tuple(point) for point in whole.tolist()}
        assert 0.5 < len(left) / len(whole) < 0.9
    clean = said_in(["sensors.hazcam.faults={lens: {dust: 1.0}}"])["/hazcam/points"]
    assert all(len(points_of("/hazcam/points", message)) == 0 for message in clean)


def test_stuck_repeats_the_last_reading_with_new_stamps(sound: Said) -> None:
    stuck = said_in(["sensors.joint_faults={all: {stuck: true, after: 1.0}}"])["/joint_states"]
    assert [message.stamp for message in stuck] == [message.stamp for message in sound["/joint_states"]]
    held = next(message for message in sound["/joint_states"] if message.stamp == 49 * CONTROL_PERIOD_NS)
    for message in stuck:
        if message.stamp >= 50 * CONTROL_PERIOD_NS:
            np.testing.assert_array_equal(message.position, held.position)


def test_the_same_seed_gives_the_same_and_another_gives_others() -> None:
    told = GYRO + "spike_probability: 0.3, spike_size: 1.0}}"
    table = table_of(load_scenario("flat_drive"))
    first, again, other = (
        as_bytes(table, "/imu/data", said_in([told, *more])["/imu/data"]) for more in ((), (), ("seed=99",))
    )
    assert first == again != other


def test_a_kept_state_is_gone_on_from_with_what_waits_in_it() -> None:
    told = ["sensors.imu.timing={latency: 0.1, jitter: 0.1}", "sensors.joint_faults={a: {stuck: true, after: 0.6}}"]
    stack = stack_of(told, CLOSED)
    state, _ = gone_on(stack, stack.begin()[0], 35)
    _, first = gone_on(stack, state, 30)
    _, second = gone_on(stack, state, 30)
    table = table_of(load_scenario("flat_drive", told))
    assert all(as_bytes(table, name, first[name]) == as_bytes(table, name, second[name]) for name in first)
    assert len(first["/imu/data"]) > 20


def drive_status(said: Said) -> dict[str, str]:
    return status_values(said["/drive/status"][-1])


SILENT = int((PATIENCE_S + 2.5) / CONTROL_PERIOD_S)


@pytest.mark.parametrize(
    ("told", "topic"),
    [
        ("sensors.imu.faults={a: {dead: true, after: 1.0}}", "/imu/data"),
        ("sensors.joint_faults={a: {dead: true, after: 1.0}}", "/joint_states"),
    ],
)
def test_a_dead_sensor_ends_the_goal_in_words(told: str, topic: str) -> None:
    said = said_in([told], CLOSED, SILENT)
    assert all(message.stamp < CONTROL_PERIOD_NS * 50 for message in said[topic])
    assert all(np.all(np.isfinite(message.position)) for message in said["/odom"])
    assert f"no usable {topic} for" in str(drive_status(said))


@pytest.mark.parametrize("sensor", ["imu", "joint"])
def test_a_stuck_sensor_neither_stops_the_run_nor_spoils_the_odometry(sensor: str) -> None:
    key = "sensors.joint_faults" if sensor == "joint" else "sensors.imu.faults"
    said = said_in([key + "={a: {stuck: true, after: 1.0}}"], CLOSED, SILENT)
    assert all(np.all(np.isfinite(message.position)) for message in said["/odom"])
    assert drive_status(said)["state"]


@pytest.mark.parametrize(
    ("sensor", "of", "topic"),
    [
        ("imu", "angular_velocity", "/imu/data"),
        ("imu", "orientation", "/imu/data"),
        ("joint_groups", "position", "/joint_states"),
        ("joint_groups", "velocity", "/joint_states"),
    ],
)
def test_no_number_enters_the_odometry_that_is_none(sensor: str, of: str, topic: str) -> None:
    """As a schedule would switch it: what is wrong is a value in the state."""
    key = "sensors.joint_faults" if sensor == "joint_groups" else f"sensors.{sensor}.faults"
    stack = stack_of([f"{key}={{a: {{of: {of}, bias: 1.0, after: 1.0e6}}}}"], CLOSED)
    state, _ = gone_on(stack, stack.begin()[0], 50)
    none = SensorFaultParams.model_construct(of=of, bias=float("nan"))
    memory: SensorsState = state.roles["sensors"].app
    faulty = {sensor: FaultyState((("a", none),), memory.faulty[sensor].last)}
    role = replace(state.roles["sensors"], app=replace(memory, faulty=faulty))
    state = replace(state, roles={**state.roles, "sensors": role})
    _, said = gone_on(stack, state, SILENT)
    assert any(np.any(np.isnan(getattr(message, of))) for message in said[topic])
    assert all(np.all(np.isfinite(message.position)) for message in said["/odom"])
    assert f"no usable {topic}" in str(drive_status(said))


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ("sensors.imu.faults={a: {bias: 1.0}}", "a fault of one of angular_velocity, specific_force"),
        ("sensors.imu.faults={a: {of: temper, bias: 1.0}}", "a fault of one of angular_velocity"),
        (
            "sensors.imu.faults={a: {of: angular_velocity, bias: [1.0, 2.0]}}",
            "as many as there are",
        ),
        ("sensors.bus.faults={a: {of: voltage, bias: 1.0}}", "no quantity: there is one alone"),
        ("sensors.hazcam.faults={a: {dust: 0.1, bias: 1.0}}", "dust: allowed is a fault of its own"),
        ("sensors.imu.faults={a: {dust: 0.1}}", "no dust: it has no lens"),
        ("sensors.imu.faults={a: {after: 3.0}}", "nothing is wrong by it"),
        ("sensors.imu.faults={a: {bias: 1.0, spike_size: 3.0}}", "spike_probability and spike_size together"),
        ("sensors.imu.faults={a: {of: orientation, dead: true}}", "allowed with scale"),
        ("sensors.imu.faults={a: {dropout: 1.5}}", "dropout"),
        ("sensors.imu.faults={a: {broken: true}}", "broken"),
        ("sensors.imu.faults=3", "faults"),
    ],
)
def test_a_fault_that_cannot_be_is_refused_in_words(told: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        stack_of([told], OPEN)
