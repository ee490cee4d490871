"""Slip: the belief inverted, loads against statics, the speed filter against many made-up drives, wheels in trouble."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_load_map import wheel_load_map
from sojourn_flight.odometry import speed_filter
from sojourn_flight.odometry.slip_estimation import SlipInput, SlipModel, SlipState, estimate_slip
from sojourn_flight.odometry.slip_params import SlipParams
from sojourn_flight.odometry.slip_status import further_slip, slip_status, trouble
from sojourn_flight.odometry.traction import believed_slip, coefficient, in_rut, slope
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.inertial_errors import CORRELATION_TIMES, FLICKER_SHARES
from wheel_drive import wheel_loads_of

CURVES = np.array([[0.58, 0.40, 0.06], [0.58, 0.59, 0.01]])
KINDS = np.array([0, 0, 1, 1, 1, 1])
DT = 0.02
GRAVITY = 1.625


@settings(deadline=None)
@given(st.floats(-0.5, 0.95), st.lists(st.floats(1.0, 20.0), min_size=6, max_size=6))
def test_the_belief_gives_back_the_slip_that_makes_its_torques(slip: float, loads: list[float]) -> None:
    levers = np.array(loads)
    torques = levers * np.array([coefficient(CURVES[kind], slip) for kind in KINDS])
    found, per_torque = believed_slip(torques, levers, KINDS, np.ones(6), CURVES)
    assert found == pytest.approx(slip, abs=1e-8)
    step = 1e-6
    ahead = sum(lever * coefficient(CURVES[kind], slip + step) for lever, kind in zip(levers, KINDS, strict=True))
    assert per_torque == pytest.approx(step / (ahead - torques.sum()), rel=1e-4)
    assert slope(CURVES[0], slip) > 0.0


def test_a_wheel_that_does_not_count_and_torque_beyond_all_traction() -> None:
    levers, counts = np.full(6, 6.0), np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
    torques = levers * np.array([coefficient(CURVES[kind], 0.3) for kind in KINDS])
    torques[5] = -50.0
    assert believed_slip(torques, levers, KINDS, counts, CURVES)[0] == pytest.approx(0.3, abs=1e-8)
    assert believed_slip(levers, levers, KINDS, counts, CURVES)[0] == pytest.approx(1.0, abs=1e-8)


def test_ruts_are_behind_and_on_the_same_track(explorer: SteeringGeometryParams) -> None:
    table = explorer.table()

    def behind(x: float, y: float, way: float) -> list[bool]:
        return [in_rut(table, wheel, x, y, 0.08, way) for wheel in range(6)]

    assert behind(1.0, 0.0, 0.5) == [False] * 6, "nobody has reached the place of another yet"
    assert behind(1.0, 0.0, 1.0) == [False, False, True, True, True, True]
    assert behind(-1.0, 0.0, 1.0) == [True, True, True, True, False, False]
    assert behind(0.0, 1.0, 2.0) == [False, True, False, True, False, True]
    assert behind(math.sqrt(0.5), math.sqrt(0.5), 2.0) == [False] * 6


@pytest.fixture(scope="module")
def scenario() -> LoadedScenario:
    return load_scenario("flat_drive")


def test_expected_loads_are_those_of_statics(scenario: LoadedScenario) -> None:
    """Exactly on level ground, where no force along the ground is needed; nearly on a slope of 8 degrees."""
    angles = dict(zip(scenario.arm.joint_names, scenario.arm.named_poses["stow"], strict=True))
    loads = wheel_load_map(scenario.urdf_xml, scenario.machine, scenario.gravity, angles)
    machine = StandingMachine(scenario.urdf_xml, scenario.machine, scenario.gravity)
    level = machine.loads(machine.stand(lambda x, y: 0.0, angles=angles)).normal
    np.testing.assert_allclose(loads[:, 0], level, rtol=2e-3)
    assert loads[:, 0].sum() == pytest.approx(machine.mass * scenario.gravity, rel=1e-9)
    np.testing.assert_allclose(loads[:, 1:].sum(axis=0), 0.0, atol=1e-6)
    slope = math.radians(8.0)
    for rise_x, rise_y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0)):
        stance = machine.stand(
            lambda x, y, rise_x=rise_x, rise_y=rise_y: math.tan(slope) * (rise_x * x + rise_y * y), angles=angles
        )
        up = np.array((0.0, 0.0, 1.0)) @ Rotation.from_quat(stance.configuration[3:7]).as_matrix()
        expected = loads @ np.array((up[2], -up[0], up[1]))
        np.testing.assert_allclose(expected, machine.loads(stance).normal, rtol=0.1)


@settings(deadline=None)
@given(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3))
def test_gravity_is_carried_as_the_body_turns(rate: list[float]) -> None:
    before, turn = np.array((0.3, -0.2, -1.6)), np.array(rate)
    after = speed_filter.carry_gravity(before, turn, 0.5)
    np.testing.assert_allclose(after, Rotation.from_rotvec(-0.5 * turn).apply(before), atol=1e-12)


def made_up_flicker(coefficient: float, random: np.random.Generator) -> Iterator[FloatArray]:
    """The bias of an accelerometer, period by period, as the sensors have it, in decades from 0.1 to 1e4 s [m/s^2]."""
    sigma, kept = coefficient * np.array(FLICKER_SHARES), np.exp(-DT / np.array(CORRELATION_TIMES))
    parts = sigma * random.standard_normal(len(sigma))
    while True:
        yield parts
        parts = kept * parts + np.sqrt(1.0 - kept**2) * sigma * random.standard_normal(len(sigma))


def noise_of(params: SlipParams) -> speed_filter.ProcessNoise:
    return speed_filter.ProcessNoise(
        params.force_noise, params.accelerometer_flicker, params.drift_walk**2 * DT, params.factor_sigma,
        params.factor_length,
    )  # fmt: skip


class FilteredSpeed(NamedTuple):
    error: FloatArray
    """Of speed, of drift with what is not too fast of the flicker, and of the factor, (3,)."""
    covariance: FloatArray
    """(3, 3)"""


def made_up_drive(params: SlipParams, seed: int, moving: int = 1500, believes_wheels: bool = True) -> FilteredSpeed:
    """Five seconds at rest, then so many periods at 0.06 m/s on wheels that slip."""
    random = np.random.default_rng(seed)
    flicker = made_up_flicker(params.accelerometer_flicker, random)
    factor, drift = 1.0 + params.factor_sigma * random.standard_normal(), params.drift_sigma * random.standard_normal()
    noises = noise_of(params)
    states = np.array((0.0, 0.0, 1.0, 0.0))
    covariance = speed_filter.initial_covariance(0.1, params.drift_sigma, noises)
    speed, noise, believed, felt, wheels, parts = 0.0, 0.0, 0.2, np.zeros(2), 0.06, np.zeros(0)
    lasting = np.array(CORRELATION_TIMES) >= speed_filter.FLICKER_TIME
    kept = math.exp(-DT / params.slip_noise_time)
    for period in range(250 + moving):
        drift += params.drift_walk * math.sqrt(DT) * random.standard_normal()
        shake = params.force_noise / math.sqrt(DT) * random.standard_normal()
        parts = next(flicker)
        off = drift + float(parts.sum())
        if period < 250:
            felt = speed_filter.felt_rocking(felt, off + shake, DT)
            speed_filter.stand(states, covariance, felt, off + shake, DT, noises)
            continue
        noise = kept * noise + math.sqrt(1.0 - kept * kept) * params.slip_noise * random.standard_normal()
        after = wheels * (1.0 - factor * believed - noise)
        acceleration, speed = (after - speed) / DT, after
        speed_filter.predict(states, covariance, acceleration + off + shake, 1.0, 0.0, DT, noises)
        if believes_wheels:
            variance = (wheels * params.slip_noise) ** 2 * 2.0 * params.slip_noise_time / DT
            speed_filter.roll(states, covariance, wheels, believed, 0.0, variance)
    chosen = np.zeros((3, 4))
    chosen[0, speed_filter.SPEED] = chosen[1, speed_filter.DRIFT] = chosen[2, speed_filter.FACTOR] = 1.0
    chosen[1, speed_filter.FLICKER] = 1.0
    true = np.array((speed, drift + parts[lasting].sum(), factor))
    return FilteredSpeed(true - chosen @ states, chosen @ covariance @ chosen.T)


@pytest.mark.parametrize("seconds", [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
def test_the_speed_by_acceleration_alone_is_as_good_as_is_said(scenario: LoadedScenario, seconds: float) -> None:
    """After a stop, with a bias that flickers: believed a walk of 1e-4 m/s^2 a root of a second alone, slow wheels were
    told to spin after 4 s; of 5e-4, nothing was known after ten.
    """
    params = scenario.drive.mobility.slip
    assert params is not None
    runs = [made_up_drive(params, seed, round(seconds / DT), believes_wheels=False) for seed in range(60)]
    squares = [run.error[0] ** 2 / run.covariance[0, 0] for run in runs]
    assert chi2.ppf(1e-3, 60) / 60 < np.mean(squares) < chi2.ppf(1.0 - 1e-3, 60) / 60


def test_the_speed_filter_knows_how_good_it_is(scenario: LoadedScenario) -> None:
    """NEES of all three states over seeds; and the soil's factor is found far better than it was known."""
    params = scenario.drive.mobility.slip
    assert params is not None
    loose = params.model_copy(update={"slip_noise": 0.02, "slip_noise_time": 1.0})
    runs = [made_up_drive(loose, seed) for seed in range(40)]
    squares = [run.error @ np.linalg.solve(run.covariance, run.error) for run in runs]
    assert np.mean(squares) < chi2.ppf(0.9995, 3 * len(runs)) / len(runs)
    assert np.mean(squares) > 0.25 * 3.0, "it may doubt itself, but not by a factor of two"
    factors = [run.error[2] for run in runs]
    assert np.sqrt(np.mean(np.square(factors))) < 0.4 * params.factor_sigma


def model_of(scenario: LoadedScenario) -> SlipModel:
    params = scenario.drive.mobility.slip
    assert params is not None
    return SlipModel.of(params, scenario.steering.table(), wheel_loads_of(scenario))


@pytest.fixture
def model(scenario: LoadedScenario) -> SlipModel:
    return model_of(scenario)


def roll(
    model: SlipModel,
    state: SlipState,
    seconds: float,
    slip: float,
    rates: FloatArray,
    commands: FloatArray | None = None,
    torque_of: FloatArray | None = None,
    force: FloatArray | None = None,
) -> SlipState:
    """Wheels that turn at these rates on the believed soil, on level ground, with one slip; in steady motion, or with a
    specific force.
    """
    levers = model.machine.table[:, 2] * model.machine.loads[:, 0]
    share = np.ones(6) if torque_of is None else torque_of
    for _ in range(round(seconds / DT)):
        kinds = [int(in_rut(model.machine.table, i, 1.0, 0.0, model.params.rut_width, state.way)) for i in range(6)]
        torques = share * levers * np.array([coefficient(model.machine.curves[kind], slip) for kind in kinds])
        felt = np.array((0.0, 0.0, GRAVITY)) if force is None else force
        seen = SlipInput(
            rates, rates if commands is None else commands, np.zeros(6), torques, np.zeros(3), felt, (0.0, 0.0)
        )
        state = estimate_slip(model, state, seen, DT)
    return state


def moving(model: SlipModel, speed: float, slip: float) -> SlipState:
    """A state that knows its speed."""
    state = model.initial_state()
    covariance = state.covariance.copy()
    covariance[0, 0] = 1e-6
    force = np.array((0.0, 0.0, -GRAVITY))
    return state._replace(states=np.array((speed * (1.0 - slip), 0.0, 1.0, 0.0)), covariance=covariance, gravity=force)


@settings(max_examples=8, deadline=None)
@given(slip=st.floats(0.0, 0.5), speed=st.floats(0.03, 0.1))
def test_slip_of_a_machine_on_the_believed_soil(slip: float, speed: float, scenario: LoadedScenario) -> None:
    model = model_of(scenario)
    rates = np.full(6, speed / 0.131)
    state = roll(model, moving(model, speed, slip), 10.0, slip, rates)
    np.testing.assert_allclose(state.slip, slip, atol=0.03)
    assert abs(state.shared - slip) < 3.0 * state.sigma
    assert trouble(model.params, state, tuple("abcdef")) == ""


def test_wheels_that_disagree_have_each_its_own_slip(model: SlipModel) -> None:
    """One wheel turns a fifth faster than the others: its slip is more by what the kinematics say."""
    rates = np.full(6, 0.5)
    rates[2] = 0.6
    state = roll(model, moving(model, 0.0655, 0.2), 5.0, 0.2, rates)
    others = np.delete(state.slip, 2)
    assert np.ptp(others) < 0.03
    assert 1.0 - state.slip[2] == pytest.approx((1.0 - others.mean()) / 1.2, abs=0.01)


def test_wheels_in_trouble_are_named(model: SlipModel) -> None:
    names = tuple("abcdef")
    rates, free = np.full(6, 0.5), np.ones(6)
    free[4] = 0.0
    state = roll(model, moving(model, 0.0655, 0.3), 1.0, 0.3, rates)
    assert "without load" not in trouble(model.params, roll(model, state, 1.5, 0.3, rates, torque_of=free), names)
    assert (
        trouble(model.params, roll(model, state, 4.5, 0.3, rates, torque_of=free), names) == "turning without load: e"
    )
    stood = rates.copy()
    stood[1] = 0.0
    state = roll(model, moving(model, 0.0655, 0.1), 2.0, 0.1, stood, commands=rates)
    assert trouble(model.params, state, names).endswith("blocked: b")
    assert state.slip[1] == pytest.approx(-1.0)
    assert trouble(model.params, roll(model, state, 0.1, 0.1, rates), names) == ""


def test_a_machine_that_spins_on_the_spot_is_stuck_within_two_seconds(model: SlipModel) -> None:
    """Torque at the limit from one moment to the next, and the accelerometers have felt the stop."""
    rates = np.full(6, 0.5)
    state = roll(model, moving(model, 0.0655, 0.2), 5.0, 0.2, rates)
    stopping = SlipInput(
        rates,
        rates,
        np.zeros(6),
        model.machine.table[:, 2] * model.machine.loads[:, 0] * 0.55,
        np.zeros(3),
        np.array((-state.states[0] / 0.2, 0.0, GRAVITY)),
        (0.0, 0.0),
    )
    for _ in range(10):
        state = estimate_slip(model, state, stopping, DT)
    still = stopping._replace(specific_force=np.array((0.0, 0.0, GRAVITY)))
    for _ in range(90):
        state = estimate_slip(model, state, still, DT)
    assert trouble(model.params, state, tuple("abcdef")).startswith("spinning without headway")
    assert trouble(model.params, state, tuple("abcdef")).endswith("a, b, c, d, e, f")


def test_the_slip_does_not_run_away_while_the_wheels_slow_down(scenario: LoadedScenario) -> None:
    """A machine that brakes evenly with a constant slip, the accelerometer off by 1.5 of its deviations from when on.

    -0.57 was told of 0.25 as long as the change of the wheels' speed counted as a doubt of what they say: in the plant
    1.0 of 0.3 at the end of a way along 12 degrees.
    """
    model, slip, drift = model_of(scenario), 0.25, 1.5e-3
    state = roll(model, moving(model, 0.1, slip), 8.0, slip, np.full(6, 0.1 / model.machine.table[0, 2]))
    told, speed = [], 0.1
    for _ in range(round(4.6 / DT)):
        speed -= 0.02 * DT
        force = np.array((drift - 0.02 * (1.0 - slip), 0.0, GRAVITY))
        state = roll(model, state, DT, slip, np.full(6, speed / model.machine.table[0, 2]), force=force)
        told.append((state.shared, state.sigma))
    slips, sigmas = np.array(told).T
    assert speed == pytest.approx(0.008) and state.observable
    assert np.abs(slips - slip).max() < 0.2
    assert (np.abs(slips - slip) < 3.0 * sigmas).all()


def test_a_few_millimetres_a_second_of_doubt_are_no_loss_of_headway(model: SlipModel) -> None:
    """Wheels at the end of a way, so slow that a speed off by three deviations is a slip of 1."""
    state = moving(model, 0.008, 0.1)
    covariance = state.covariance.copy()
    covariance[0, 0] = 2.5e-3**2
    state = state._replace(states=np.array((-3e-4, 0.0, 1.0, 0.0)), covariance=covariance)
    rates = np.full(6, 0.008 / model.machine.table[0, 2])
    state = roll(model, state, DT, 0.1, rates)
    assert state.shared > model.params.stuck_slip
    assert not state.stuck_for.any()


@pytest.mark.parametrize("gap", [0.2, 0.4, 1.0])
def test_what_was_felt_in_one_reading_is_not_taken_for_all_of_a_gap(gap: float, model: SlipModel) -> None:
    """A busy machine: the reading of a jolt, and none for a while. The speed was off by the jolt times the gap, without
    a doubt, and wheels that rolled were told to spin.
    """
    rates = np.full(6, 0.08 / model.machine.table[0, 2])
    state = roll(model, moving(model, 0.08, 0.2), 5.0, 0.2, rates)
    levers = model.machine.table[:, 2] * model.machine.loads[:, 0]
    torques = levers * coefficient(model.machine.curves[1], 0.2)
    jolt = np.array((-0.3, 0.0, GRAVITY))
    state = estimate_slip(
        model, state, SlipInput(rates, rates, np.zeros(6), torques, np.zeros(3), jolt, (0.0, 0.0)), gap
    )
    assert abs(state.shared - 0.2) < 3.0 * state.sigma
    for _ in range(5):
        state = roll(model, state, 0.4, 0.2, rates)
        assert abs(state.shared - 0.2) < 3.0 * state.sigma
        assert trouble(model.params, state, tuple("abcdef")) == ""


def halt(model: SlipModel, state: SlipState, speed: float) -> SlipState:
    """Wheels that roll at `speed` [m/s] stop within a fifth of a second, and the body with them."""
    slowing, stands = np.array((-speed / 0.2, 0.0, GRAVITY)), np.zeros(6)
    for period in range(10):
        rates = np.full(6, speed * (1.0 - 0.1 * (period + 1)) / 0.131)
        seen = SlipInput(rates, rates, stands, stands, np.zeros(3), slowing, (0.0, 0.0))
        state = estimate_slip(model, state, seen, DT)
    return roll(model, state, 0.1, 0.0, stands)


@pytest.mark.parametrize("speed", [0.1, -0.1])
def test_a_machine_that_stops_has_no_speed_left_and_no_slip(model: SlipModel, speed: float) -> None:
    """Backwards as forwards: the speed is along the motion of the wheels, also when they have just come to rest."""
    state = moving(model, abs(speed), 0.0)
    state = state._replace(ahead=np.array((math.copysign(1.0, speed), 0.0)), way=1.0)
    stopped = halt(model, roll(model, state, 0.5, 0.0, np.full(6, speed / 0.131)), speed)
    assert abs(stopped.states[0]) < 0.015
    assert stopped.way >= 1.0, "it still stands in its ruts"
    for state in (stopped, roll(model, stopped, 2.0, 0.0, np.zeros(6))):
        assert not state.observable and state.shared == 0.0
        told = slip_status(model, state, tuple("abcdef"))
        assert [told[key] for key in told if key.startswith("slip")] == [0.0] * 8


def test_wheels_that_turn_on_the_spot_tell_no_slip_of_the_machine(model: SlipModel, scenario: LoadedScenario) -> None:
    """Base_link goes aside by a little more than least_speed while the rims go ten times as fast."""
    state, turning = moving(model, 0.0, 0.0), np.array((0.0, 0.0, 0.08))
    wheels = wheels_from_twist(scenario.steering.table(), PlanarTwist(0.007, 0.0, 0.08), np.zeros(6))
    for _ in range(100):
        seen = SlipInput(
            wheels.wheel_rates, wheels.wheel_rates, wheels.steer_angles, np.zeros(6), turning,
            np.array((0.0, 0.0, GRAVITY)), (0.0, 0.0),
        )  # fmt: skip
        state = estimate_slip(model, state, seen, DT)
    assert not state.observable and state.shared == 0.0 and state.way == 0.0
    assert state.states[2] == pytest.approx(1.0, abs=1e-3), "and nothing is learned of the soil"


def test_a_turn_makes_the_levelling_doubtful(model: SlipModel) -> None:
    """Against the spread of b cos t - b for biases that the levelling took for tilt, in both axes of base_link, while
    the speed, which would tell of the drift, is forgotten in each period.
    """
    state, random, drift = moving(model, 0.0, 0.0), np.random.default_rng(1), 1e-12
    bias = model.params.accelerometer_bias * random.standard_normal((2, 20_000))
    rates, turned = np.full(6, 1e-3), 0.0
    for _ in range(1000):
        seen = SlipInput(
            rates, rates, np.zeros(6), np.zeros(6), np.array((0.0, 0.0, 0.1)), np.array((0.0, 0.0, GRAVITY)), (0.0, 0.0)
        )
        known = state._replace(states=np.array((0.0, 0.0, 1.0, 0.0)), covariance=np.diag((1e-9, drift, 1e-6, 0.0)))
        state = estimate_slip(model, known, seen, DT)
        drift = float(state.covariance[1, 1])
        turned += 0.1 * DT
    spread = np.std(bias[0] * math.cos(turned) + bias[1] * math.sin(turned) - bias[0])
    walked = model.params.drift_walk**2 * 1000 * DT  # it would have without a turn
    assert 0.9 * spread < math.sqrt(drift - walked) < 1.3 * spread


def test_a_body_that_rocks_at_a_stand_is_not_taken_for_one_at_rest(model: SlipModel) -> None:
    """Wheels stand and the body swings by 20 mm/s at 1.3 Hz for three seconds: the drift is not learned from that."""
    state, rate, stands = moving(model, 0.0, 0.0), 2.0 * math.pi * 1.3, np.zeros(6)
    for period in range(150):
        swing = 0.02 * rate * math.cos(rate * DT * period)
        seen = SlipInput(stands, stands, stands, stands, np.zeros(3), np.array((swing, 0.0, GRAVITY)), (0.0, 0.0))
        state = estimate_slip(model, state, seen, DT)
        assert abs(state.states[1]) < 3.0 * math.sqrt(state.covariance[1, 1]), "the true drift is none"
    assert abs(state.states[1]) < 2e-3


@pytest.mark.parametrize("slip", [-0.5, 0.0, 0.3, 0.9])
@pytest.mark.parametrize("error", [-0.4, 0.0, 0.6])
def test_further_slip_is_that_of_the_shorter_way(slip: float, error: float) -> None:
    """Against the definition: a rim of 1 m/s or, of a wheel that drags, ground of 1 m/s."""
    rim, ground = (1.0, 1.0 - slip) if slip >= 0.0 else (1.0 + slip, 1.0)
    ground *= 1.0 - error
    assert further_slip(slip, error) == pytest.approx((rim - ground) / max(rim, ground))


def at_rest_then_driving(model: SlipModel, spin: tuple[float, float], up: FloatArray, slip: float) -> list[SlipState]:
    """The states after 250 s at rest, where gyros as an LN-200S's feel the planet's spin, and after 20 s of driving."""
    levers = model.machine.table[:, 2] * model.machine.loads[:, 0]
    random = np.random.default_rng(1)
    sigmas = np.array((2e-5, model.params.force_noise)) / math.sqrt(DT)
    speed, states = 0.05, []
    state = model.initial_state()._replace(gravity=-up)
    rolling, starting = np.full(6, speed / 0.131), np.array((speed * (1.0 - slip), 0.0, 0.0))
    for rates, force, seconds in ((np.zeros(6), up, 250.0), (rolling, up + starting, 1.0), (rolling, up, 19.0)):
        for _ in range(round(seconds / DT)):
            kinds = [int(in_rut(model.machine.table, i, 1.0, 0.0, model.params.rut_width, state.way)) for i in range(6)]
            torques = levers * np.array([coefficient(model.machine.curves[kind], slip) for kind in kinds])
            gyro, felt = (sigma * random.standard_normal(3) for sigma in sigmas)
            gyro[:2] += spin
            seen = SlipInput(rates, rates, np.zeros(6), torques * (rates > 0.0), gyro, felt + force, (0.0, 0.0))
            state = estimate_slip(model, state, seen, DT)
        states.append(state)
    return [states[0], states[2]]


@pytest.mark.parametrize("spin", [(0.0, 0.0), (7.0e-5, 0.0), (0.0, 7.0e-5), (3.0e-5, -6.0e-5)])
@pytest.mark.parametrize("slip", [0.0, 0.2])
def test_minutes_at_rest_on_a_planet_that_turns(spin: tuple[float, float], slip: float, model: SlipModel) -> None:
    """The gyros of a machine at rest feel the planet's spin, which is no tilt: on Mars four minutes of it were 5 cm/s^2
    of drift that was not there, and the way after it was told 30 % too short.
    """
    up = Rotation.from_euler("xy", (0.05, -0.03)).inv().apply((0.0, 0.0, 3.73))
    rested, driven = at_rest_then_driving(model, spin, up, slip)
    assert driven.shared == pytest.approx(slip, abs=0.06)
    np.testing.assert_allclose(rested.gravity, -up, atol=5e-3)
    assert rested.states[1] == pytest.approx(0.0, abs=5e-3)


@pytest.mark.parametrize("rested", [4.0, 10.0, 60.0])
@pytest.mark.parametrize("rate", [1.8e-3, -0.6e-3])
def test_tilting_on_wheels_that_are_steered_is_no_bias_of_the_gyros(
    model: SlipModel, rested: float, rate: float
) -> None:
    """A body that has stood for some seconds and tilts while the wheels are steered for the next way, as every drive
    begins: it was learned as a bias of 30 deg/h and more, by which the way after it was told 10 % too short, and a
    machine near its goal to spin without headway.
    """
    random, bias, tilt = np.random.default_rng(3), np.array((3e-5, -6e-5, 0.0)), 0.0
    state, sigma = model.initial_state(), 2e-5 / math.sqrt(DT)
    learned = np.zeros(2)
    for period in range(round((rested + 1.2 + 3.0) / DT)):
        steers = rested <= period * DT < rested + 1.2
        tilt += rate * DT * steers
        gyro = bias + sigma * random.standard_normal(3) + np.array((0.0, rate * steers, 0.0))
        up = 3.73 * np.array((-math.sin(tilt), 0.0, math.cos(tilt)))
        stands = np.zeros(6)
        seen = SlipInput(stands, stands, stands, stands, gyro, up, (0.0, tilt))
        learned = learned if steers or tilt else state.rest_rate
        state = estimate_slip(model, state, seen, DT)
    assert state.rest_rate == pytest.approx(learned, abs=4e-5)
    assert state.gravity == pytest.approx(-up, abs=5e-3), "it is carried by what the gyros tell"
