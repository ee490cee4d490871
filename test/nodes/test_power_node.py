"""The node of the power manager, alone: switches at their rate, shedding, a start in mid-run."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from node_bench import Bench, at, battery, stamp_of
from rosgraph_msgs.msg import Clock
from test_drive_node import send_event

from ros_messages import ros_message, value_of
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.switches import check_switches
from sojourn_power.node import PowerNode

HIGH, LOW = 29.5, 25.0
"""Voltage of the battery at rest, well charged and near its end [V]."""


def run(bench: Bench, first: int, last: int, voltage: float, current: float = 2.0) -> dict[str, str]:
    """Telemetry at 10 Hz; the switches at the end."""
    for period in range(first, last + 1, 5):
        bench.send("/bus/state", battery(period, voltage, current))
        answer = bench.answer("/power/switches", period)
    return status_values(value_of(answer))


@pytest.fixture
def power(bench: Bench) -> PowerNode:
    node = bench.start(PowerNode, "sensors", "power")
    bench.connect(node)
    return node


def test_switches_ten_times_a_second(bench: Bench, power: PowerNode) -> None:
    switches = run(bench, 5, 100, HIGH)
    assert [stamp_of(message) for message in bench.received["/power/switches"]] == [at(p) for p in range(5, 101, 5)]
    assert set(switches.values()) <= {"on"} and {"drive", "steer", "arm"} <= set(switches)
    state = bench.answer("/battery_state", 100)
    assert (state.voltage, state.current) == pytest.approx((HIGH, -2.0))
    assert 0.2 < state.percentage < 1.0
    assert state.charge == pytest.approx(state.percentage * state.capacity, rel=1e-5)
    assert [stamp_of(message) for message in bench.received["/battery_state"]] == [at(50), at(100)]
    assert bench.status("/power/status", 100)["state"] == "normal"


def test_sheds_when_the_charge_is_low(bench: Bench, power: PowerNode) -> None:
    switches = run(bench, 5, 1500, LOW)
    check_switches("/power/switches", switches)
    status = bench.status("/power/status", 1500)
    assert float(status["soc"]) < 0.25
    off = {load for load, text in switches.items() if text == "off"}
    assert off and set(status["shed"].split(",")) == off
    assert status["state"] == "shedding" and status["reason"]


def test_a_clock_that_it_goes_by_does_not_hurry_it(bench: Bench) -> None:
    """In real time, where the bus is late and nothing else is heard at a rate: it acted at every beat of the clock."""
    late = ["sensors.bus.timing={latency: 0.06}"]
    node = bench.start(PowerNode, "plant", "sensors", "power", lockstep=False, overrides=late)
    bench.connect(node, lockstep=False)
    for period in range(1, 41):
        if period % 5 == 3 and period > 5:
            bench.send("/bus/state", battery(period - 3, HIGH))
        bench.send("/clock", Clock(clock=Time(sec=0, nanosec=at(period))))
        bench.spin(0.02)  # no clock of a run is faster than the wall's
    bench.until(lambda: at(40) in map(stamp_of, bench.received["/power/switches"]), "it has acted")
    assert {stamp_of(message) % at(5) for message in bench.received["/power/switches"]} == {0}


@pytest.mark.parametrize("known", [False, True])
def test_telemetry_that_no_battery_can_have_is_refused(bench: Bench, power: PowerNode, known: bool) -> None:
    """It ended the node: what the law cannot take is refused with its reason, as what the contract cannot."""
    before = run(bench, 5, 45, HIGH) if known else {}
    period = 50 if known else 5
    absurd = battery(period, HIGH)
    absurd.temperature = -1.6e29
    bench.send("/bus/state", absurd)
    assert status_values(value_of(bench.answer("/power/switches", period))) == before
    assert power.counters.refused == {"/bus/state": 1} and "temperature" in power.counters.last_refusal


def test_telemetry_that_is_none_is_refused_and_the_last_good_one_counts(bench: Bench, power: PowerNode) -> None:
    bench.send("/bus/state", battery(5, math.nan))
    assert status_values(value_of(bench.answer("/power/switches", 5))) == {}, "nothing is known, nothing is switched"
    before = run(bench, 10, 45, HIGH)
    assert run(bench, 50, 60, math.nan) == before
    assert bench.answer("/battery_state", 50).voltage == pytest.approx(HIGH)
    assert power.counters.refused == {"/bus/state": 4}
    assert "/bus/state.voltage = nan" in power.counters.last_refusal


def ask(bench: Bench, node: PowerNode, period: int, **switches: str) -> dict[str, str]:
    """Ask for switches; the status at `period`, a whole second."""
    request = ros_message(status_message(at(period - 10), "request", switches))
    send_event(bench, node, "/power/request", request)
    run(bench, period - 45, period, HIGH)
    status = bench.status("/power/status", period)
    assert int(status["request_stamp"]) == at(period - 10)
    return status


def test_an_operator_switches_loads(bench: Bench, power: PowerNode) -> None:
    run(bench, 5, 50, HIGH)
    none = bench.status("/power/status", 50)
    assert (none["request_state"], none["request_stamp"]) == ("none", "0")
    status = ask(bench, power, 100, cameras="off", arm="off")
    assert (status["request"], status["request_state"]) == ("cameras off, arm off", "done")
    assert status["shed"] == "arm,cameras" and status["request_reason"] == ""
    switches = run(bench, 105, 105, HIGH)
    assert {load for load, text in switches.items() if text == "off"} == {"cameras", "arm"}
    status = ask(bench, power, 150, cameras="on")
    assert (status["request_state"], status["shed"]) == ("done", "arm")


@pytest.mark.parametrize(
    ("switches", "words"),
    [
        ({"cameras": "off", "computer": "off"}, "essential load computer"),
        ({"camera": "off"}, "did you mean cameras"),
        ({"cameras": "dim"}, "on or off"),
        ({}, "at least one load"),
    ],
)
def test_a_request_that_is_not_safe_is_refused_whole(
    bench: Bench, power: PowerNode, switches: dict[str, str], words: str
) -> None:
    status = ask(bench, power, 50, **switches)
    assert status["request_state"] == "refused" and words in status["request_reason"]
    assert status["shed"] == "" and status["state"] == "normal"
    assert power.counters.refused == {"/power/request": 1} and words in power.counters.last_refusal
    assert power.counters.last_refusal.count("allowed is") <= 1, "the reason is said once"


def test_a_request_before_the_first_telemetry_is_kept(bench: Bench, power: PowerNode) -> None:
    send_event(bench, power, "/power/request", ros_message(status_message(0, "request", {"cameras": "off"})))
    bench.send("/bus/state", battery(5, math.nan))
    bench.answer("/power/switches", 5)
    assert run(bench, 10, 10, HIGH)["cameras"] == "off"


def test_a_load_that_is_shed_waits(bench: Bench, power: PowerNode) -> None:
    run(bench, 5, 1500, LOW)
    request = ros_message(status_message(0, "request", {"actuator_heater": "on"}))
    send_event(bench, power, "/power/request", request)
    run(bench, 1505, 1550, LOW)
    status = bench.status("/power/status", 1550)
    assert status["request_state"] == "waiting" and "shed" in status["request_reason"]


def test_started_in_the_middle_of_a_run(bench: Bench) -> None:
    """The time before it started is not counted as discharge."""
    node = bench.start(PowerNode, "sensors", "power", lockstep=False)
    bench.connect(node, lockstep=False)
    run(bench, 500_000, 500_050, HIGH, current=5.0)
    status = bench.status("/power/status", 500_050)
    assert float(status["soc"]) > 0.3 and status["state"] == "normal"


def test_a_filter_tells_its_deviation_and_the_capacity(bench: Bench) -> None:
    node = bench.start(PowerNode, "sensors", "power", overrides=["power_manager.estimator=kalman"])
    bench.connect(node)
    run(bench, 5, 100, HIGH)
    status, state = bench.status("/power/status", 100), bench.answer("/battery_state", 100)
    assert 0.0 < float(status["soc_sigma"]) < 0.05
    factor = float(status["capacity_factor"])
    assert state.capacity == pytest.approx(factor * state.design_capacity, rel=1e-4)
    assert state.charge == pytest.approx(state.percentage * state.capacity, rel=1e-4)


def test_a_switch_that_is_stuck_is_told_in_words_and_numbers(bench: Bench, power: PowerNode) -> None:
    noise = np.random.default_rng(4)

    def go(first: int, last: int) -> str:
        for period in range(first, last + 1, 5):
            bench.send("/bus/state", battery(period, HIGH, 2.6 + 0.02 * noise.standard_normal()))
            bench.answer("/power/switches", period)
        return bench.status("/power/status", last)["faults"]

    assert go(5, 350) == ""
    send_event(bench, power, "/power/request", ros_message(status_message(0, "request", {"cameras": "off"})))
    assert go(355, 600) == ""  # 5 s after it
    assert go(605, 700).startswith("cameras switch stuck on: ")  # and 7 s
    send_event(bench, power, "/power/request", ros_message(status_message(0, "request", {"cameras": "on"})))
    assert "cameras switch stuck off: " in go(705, 1050)  # the current has never changed
