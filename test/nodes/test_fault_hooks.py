"""Faults on single readings of any form: the equation, the form kept, spikes as often and as high as asked for."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.fault_messages import FaultEvent, fault_message
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.values import Odometry
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_fault import SensorFault
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.fault_hooks import FaultNow, faulted
from sojourn_sensors.supply import LOADS

NUMBERS = st.floats(-1e6, 1e6)


@dataclass(frozen=True, slots=True)
class TwoQuantities:
    force: FloatArray
    heat: float
    name: str = "gauge"


def fault_of(of: str = "", time: float = 2.0, number: int = 1, **keys: Any) -> FaultNow:
    return FaultNow(SensorFaultParams(of=of, **keys), time, 5, number)


@given(
    arrays(float, array_shapes(max_dims=2, max_side=4), elements=NUMBERS),
    NUMBERS,
    NUMBERS,
    NUMBERS,
    st.floats(0.0, 1e4),
)
def test_the_equation_holds_for_each_number(
    x: FloatArray, scale: float, bias: float, drift: float, time: float
) -> None:
    fault = FaultNow(SensorFaultParams.model_construct(scale=scale, bias=bias, drift=drift), time, 1, 1)
    wrong = faulted(x, fault)
    assert wrong.shape == x.shape and wrong.dtype == x.dtype
    for place, value in np.ndenumerate(x):
        size = abs(scale * value) + abs(bias) + abs(drift * time)
        assert wrong[place] == pytest.approx(scale * value + bias + drift * time, abs=1e-12 * size)


@given(arrays(np.float32, 3, elements=st.floats(-100.0, 100.0, width=32)))
def test_a_swapped_sign_is_swapped_back(x: FloatArray) -> None:
    swapped = faulted(x, fault_of(scale=-1.0))
    assert swapped.dtype == np.float32
    np.testing.assert_array_equal(faulted(swapped, fault_of(scale=-1.0)), x)


def test_a_reading_keeps_its_form_and_its_other_quantities() -> None:
    reading = ("left", TwoQuantities(np.array([1.0, 2.0]), 3.0))
    side, wrong = faulted(reading, fault_of("heat", bias=0.5))
    assert side == "left" and wrong.heat == 3.5 and wrong.name == "gauge"
    np.testing.assert_array_equal(wrong.force, reading[1].force)
    np.testing.assert_array_equal(faulted(reading, fault_of("force", scale=(2.0, 3.0)))[1].force, [2.0, 6.0])
    assert faulted(4.0, fault_of(drift=0.25)) == 4.5
    np.testing.assert_array_equal(reading[1].force, [1.0, 2.0])


@pytest.mark.parametrize("reading", [None, "text", np.arange(3), TwoQuantities(np.zeros(2), 0.0)])
def test_what_has_no_such_numbers_is_refused(reading: Any) -> None:
    with pytest.raises(ValueError, match=r"numbers|one of force, heat"):
        faulted(reading, fault_of(bias=1.0))


@pytest.mark.parametrize("probability", [0.02, 0.5, 1.0])
def test_spikes_come_as_often_as_asked_for_to_either_side(probability: float) -> None:
    count = 4000
    spikes = np.array(
        [
            faulted(np.zeros(2), fault_of(number=number, spike_probability=probability, spike_size=3.0))
            for number in range(count)
        ]
    )
    assert set(np.unique(spikes)) <= {-3.0, 0.0, 3.0}
    for each in spikes.T:
        spread = 5.0 * (count * probability) ** 0.5
        assert abs(np.count_nonzero(each) - count * probability) <= spread * (1.0 - probability) ** 0.5
        assert abs(np.sum(np.sign(each))) < spread
    assert np.any(spikes[:, 0] != spikes[:, 1])


@pytest.mark.parametrize("kind", [float, np.float32])
@pytest.mark.parametrize("scale", [0.0, -1.0, 1e9])
def test_what_is_no_number_stays_what_it_is(kind: type, scale: float) -> None:
    """Nothing that came back is neither too near nor a distance, whatever factor the numbers have."""
    told: Any = np.array([math.inf, -math.inf, math.nan, 2.0], dtype=kind)
    wrong = faulted(told, fault_of(scale=scale, bias=0.5, spike_probability=1.0, spike_size=3.0))
    np.testing.assert_array_equal(wrong[:3], told[:3])
    assert wrong.dtype == kind and abs(wrong[3] - (2.0 * scale + 0.5)) == pytest.approx(3.0, abs=1e-7 * scale * 2.0)
    assert faulted(math.inf, fault_of(scale=scale)) == math.inf


@pytest.mark.parametrize("key", ["scale", "bias", "drift"])
@pytest.mark.parametrize("value", ["1.0e308", "[0.0, 0.0, -1.0e10]"])
def test_no_fault_makes_a_number_too_large_to_be_told(key: str, value: str) -> None:
    with pytest.raises(ConfigError, match=rf"{key} = .*: allowed is -1e\+09 to 1e\+09"):
        load_scenario("flat_drive", [f"sensors.imu.faults={{a: {{of: angular_velocity, {key}: {value}}}}}"])


def imu_readings(app: SensorsApp, begins: dict[int, Any], powers: Sequence[float]) -> list[FloatArray]:
    """Angular velocities that the IMU says in as many periods as there are powers of its load [W], of a machine that
    turns faster and faster. begins: faults by the period in which each comes.
    """
    truth, state = app._at_rest(), app.initial_state()
    said: list[FloatArray] = []
    place = [sensor.name for sensor in app.sensors].index("imu")
    for number, power in enumerate(powers, start=1):
        stamp = number * CONTROL_PERIOD_NS
        turned = np.array([0.0, 0.0, math.sin(0.01 * number**2), math.cos(0.01 * number**2)])
        turning = Odometry(stamp, "map", "base_link", np.zeros(3), turned, np.zeros(3), np.zeros(3))
        loads = status_message(stamp, "loads", {f"power {app.params.powered_by['imu']}": str(power)})
        inputs = {**truth.inputs, "/truth/odom": turning, "/truth/joint_states": truth.joints, LOADS: loads}
        goals = (
            [(FAULTS_TOPIC, fault_message(stamp, FaultEvent("a", begins[number], True)))] if number in begins else []
        )
        state, _ = app.step(state, Period(stamp, inputs, goals=goals))
        said.append(state.readings[place].angular_velocity)
    return said


STUCK = SensorFault.model_validate({"sensor": "imu", "stuck": True, "at": 0.0})
IMU_FED = "sensors.powered_by={imu: imu}"


def test_a_sensor_that_gets_stuck_repeats_what_it_said_before() -> None:
    """By a schedule as by its table: not the first reading after."""
    app = SensorsApp(load_scenario("flat_drive", [IMU_FED]))
    sound = imu_readings(app, {}, [5.0] * 8)
    stuck = imu_readings(app, {5: STUCK}, [5.0] * 8)
    np.testing.assert_array_equal(stuck[:4], sound[:4])
    np.testing.assert_array_equal(stuck[4:], [sound[3]] * 4)
    after = 5 * CONTROL_PERIOD_NS * 1e-9
    table = SensorsApp(
        load_scenario("flat_drive", [IMU_FED, f"sensors.imu.faults={{a: {{stuck: true, after: {after}}}}}"])
    )
    np.testing.assert_array_equal(imu_readings(table, {}, [5.0] * 8), stuck)


@pytest.mark.parametrize("begin", [3, 5, 6])
def test_a_stuck_sensor_without_power_is_as_silent_as_any(begin: int) -> None:
    """And when its power is back it says again what it said before it got stuck, or before the power went."""
    app = SensorsApp(load_scenario("flat_drive", [IMU_FED]))
    said = imu_readings(app, {begin: STUCK}, [5.0, 5.0, 5.0, 5.0, 0.0, 0.0, 5.0, 5.0])
    assert np.isfinite(said[3]).all() and np.isnan(said[4:6]).all() and np.isfinite(said[6:]).all()
    if begin < 6:
        np.testing.assert_array_equal(said[6:], [said[begin - 2]] * 2)


BUS_WORDS = "no quantity: there is one alone"
MOTORS = "[wheel_front_left_joint, wheel_front_left_joint]"


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ("sensors.bus.faults={c: {of: current, bias: -1.5}}", rf"sensors\.yaml\).*bus\.faults\.c\.of.*{BUS_WORDS}"),
        ("sensors.imu.faults={c: {of: nope, bias: 1.0}}", r"imu\.faults\.c\.of = 'nope': a fault of one of angular"),
        ("sensors.imu.faults={c: {dust: 0.5}}", r"imu\.faults\.c\.dust.*it has no lens"),
        ("sensors.joint_faults={c: {of: angle, bias: 1.0}}", r"joint_faults\.c\.of.*position, velocity, effort"),
        (
            "faults=[{kind: sensor, sensor: imu, of: nope, drift: 1.0, at: 1.0}]",
            r"faults\[0\]\.of.*one of angular_velocity",
        ),
        ("faults=[{kind: sensor, sensor: bus, of: current, bias: 1.0, at: 1.0}]", rf"faults\[0\]\.of.*{BUS_WORDS}"),
        (
            f"sensors.t={{kind: torque_sensor, joints: {MOTORS}, rated_torque: 60.0, zero_error: 0.0, noise: 1.0e-6}}",
            r"t\.joints\[1\].*is there above already",
        ),
        (
            "sensors.c={kind: string_currents, loads: [drive, drive], current: {resolution: 0.01, noise: 0.01, "
            "offset: 0.01, minimum: 0.0, maximum: 20.0}}",
            r"c\.loads\[1\].*is there above already",
        ),
    ],
)
def test_what_a_sensor_cannot_have_is_said_when_the_scenario_is_read(told: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", [told])


@pytest.mark.parametrize("machine", ["explorer_cameras", "explorer_night"])
def test_a_kind_says_the_quantities_that_its_readings_have(machine: str) -> None:
    """What is refused when the scenario is read its sensor refuses too, and what is not it takes."""
    small = ["sensors.navcam.lens={columns: 32, rows: 24, horizontal_view_deg: 45.4}"]
    app = SensorsApp(load_scenario("flat_drive", [f"machine={machine}", *(small if "cameras" in machine else ())]))
    truth = app._at_rest()
    names = {"", "nothing", "position", "velocity", "effort", "angular_velocity", "specific_force", "orientation"}
    for sensor in app.sensors:
        _, reading = sensor.step(sensor.initial_state(truth), truth, 0.02)
        if sensor.params.quantities is None or reading is None:
            continue
        for of in sorted(names):
            fault = fault_of(of, scale=2.0)
            if list(sensor.params.fault_problems(fault.params)):
                with pytest.raises(ValueError):
                    sensor.faulted(reading, fault)
            else:
                sensor.faulted(reading, fault)
