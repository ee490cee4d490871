"""The node of the power manager, alone: switches at their rate, shedding, a start in mid-run."""

import math

import pytest
from node_bench import Bench, at, battery, stamp_of

from ros_messages import value_of
from sojourn_contract.heartbeat import status_values
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


def test_started_in_the_middle_of_a_run(bench: Bench) -> None:
    """The time before it started is not counted as discharge."""
    node = bench.start(PowerNode, "sensors", "power", lockstep=False)
    bench.connect(node, lockstep=False)
    run(bench, 500_000, 500_050, HIGH, current=5.0)
    status = bench.status("/power/status", 500_050)
    assert float(status["soc"]) > 0.3 and status["state"] == "normal"
