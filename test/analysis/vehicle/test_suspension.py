"""Springs and dampers: responses against simulation, modes against shapes, load transfer against the balance."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_analysis.vehicle.anti_dive import anti_fraction, pitch_under
from sojourn_analysis.vehicle.body_motion import (
    ElasticAxle,
    first_nulls,
    heave_and_pitch_modes,
    matrices,
    response_to_ground,
    roll_motion,
)
from sojourn_analysis.vehicle.quarter_car import (
    QuarterCar,
    damping_ratio,
    fixed_point,
    optimum_damping,
    responses,
    state_matrices,
    undamped_modes,
)
from sojourn_machine.errors import InvalidValueError

CAR = QuarterCar(240.0, 16e3, 1500.0, 160e3, 25.0)


@given(damping=st.floats(10.0, 1e5))
def test_all_damping_passes_through_the_fixed_point(damping: float) -> None:
    frequency, ratio = fixed_point(240.0, 16e3, 160e3)
    body = responses(QuarterCar(240.0, 16e3, damping, 160e3), np.array([frequency])).body
    assert abs(body[0]) == pytest.approx(ratio)


def test_optimum_damping_has_its_peak_at_the_fixed_point() -> None:
    """Of acceleration and tyre load; any other damping has a larger one near by."""
    best = QuarterCar(240.0, 16e3, optimum_damping(240.0, 16e3, 160e3), 160e3)
    frequency, _ = fixed_point(240.0, 16e3, 160e3)
    near = np.linspace(0.8 * frequency, 1.2 * frequency, 4001)
    found = responses(best, near)
    for response in (np.abs(found.acceleration), np.abs(found.tyre_load)):
        assert near[response.argmax()] == pytest.approx(frequency, abs=1e-3)
    for factor in (0.9, 1.1):
        other = responses(best._replace(damping=factor * best.damping), near)
        assert np.abs(other.acceleration).max() > np.abs(found.acceleration).max() * 1.0001


def test_responses_are_those_of_the_simulated_car() -> None:
    a, b = state_matrices(CAR)
    for frequency in (1.3, 13.0):
        w = 2.0 * math.pi * frequency
        path = solve_ivp(
            lambda t, y, w=w: a @ y + b * math.sin(w * t), (0.0, 8.0), np.zeros(4), rtol=1e-8, atol=1e-10,
            t_eval=np.linspace(7.0, 8.0, 401),
        )  # fmt: skip
        found = responses(CAR, np.array([frequency]))
        phase = np.exp(1j * w * path.t)
        assert path.y[0] == pytest.approx((found.body[0] * phase).imag, abs=1e-5)
        assert path.y[0] - path.y[2] == pytest.approx((found.travel[0] * phase).imag, abs=1e-5)
        load = CAR.tyre * (np.sin(w * path.t) - path.y[2])
        assert load == pytest.approx((found.tyre_load[0] * phase).imag, abs=2.0)


def test_modes_are_eigenvalues_without_damping() -> None:
    a, _ = state_matrices(CAR._replace(damping=0.0))
    imaginary = np.sort(np.abs(np.linalg.eigvals(a).imag))[::2] / (2.0 * math.pi)
    assert undamped_modes(CAR) == pytest.approx(imaginary)
    assert undamped_modes(CAR._replace(unsprung=0.0))[0] == pytest.approx(undamped_modes(CAR)[0], rel=5e-3)
    assert damping_ratio(CAR) == pytest.approx(1500.0 / 2.0 / math.sqrt(16e3 * 240.0))


AXLES = (ElasticAxle(1.1, 9600.0, 900.0, 1.8), ElasticAxle(-1.2, 9000.0, 800.0, 1.8))


def test_modes_are_free_motions() -> None:
    m, c, k = matrices(700.0, 420.0, AXLES)
    modes = heave_and_pitch_modes(700.0, 420.0, AXLES)
    assert len(modes) == 2
    for mode in modes:
        w = 2.0 * math.pi * mode.frequency
        s = complex(-mode.damping * w, w * math.sqrt(1.0 - mode.damping**2))
        assert abs(np.linalg.det(s * s * m + s * c + k)) < 1e-6 * abs(np.linalg.det(k))
    centres = [abs(mode.centre) for mode in modes]
    assert min(centres) < 1.2 < max(centres)  # one bounces, one pitches


def test_symmetric_vehicle_bounces_and_pitches_apart() -> None:
    axles = (ElasticAxle(1.0, 5000.0, 0.0), ElasticAxle(-1.0, 5000.0, 0.0))
    modes = {mode.frequency for mode in heave_and_pitch_modes(500.0, 300.0, axles)}
    expected = {math.sqrt(1e4 / 500.0) / (2 * math.pi), math.sqrt(1e4 / 300.0) / (2 * math.pi)}
    assert sorted(modes) == pytest.approx(sorted(expected))


def test_nulls_of_the_wheelbase() -> None:
    axles = (ElasticAxle(1.143, 5000.0, 300.0), ElasticAxle(-1.143, 5000.0, 300.0))
    bounce, pitch = first_nulls(2.286, 3.0)
    found = np.abs(response_to_ground(700.0, 420.0, axles, 3.0, np.array([bounce, pitch, 0.4])))
    assert found[0, 0] < 1e-12 < found[0, 1]
    assert found[1, 1] < 1e-12 < found[1, 0]
    # the whole response is the one of a single ground under both axles times the filter |cos(pi f l/V)|
    together = np.abs(response_to_ground(700.0, 420.0, axles, 1e9, np.array([0.4])))[0]
    assert found[2, 0] == pytest.approx(together[0] * math.cos(math.pi * 0.4 * 2.286 / 3.0))


def test_response_is_that_of_the_simulated_body() -> None:
    m, c, k = matrices(700.0, 420.0, AXLES)
    speed, frequency = 3.0, 0.8
    w = 2.0 * math.pi * frequency

    def motion(t: float, y: np.ndarray) -> np.ndarray:
        force = np.zeros(2)
        for axle in AXLES:
            angle = w * (t + axle.x / speed)
            force += np.array([1.0, -axle.x]) * (axle.rate * math.sin(angle) + axle.damping * w * math.cos(angle))
        return np.concatenate([y[2:], np.linalg.solve(m, force - c @ y[2:] - k @ y[:2])])

    path = solve_ivp(motion, (0.0, 40.0), np.zeros(4), rtol=1e-8, atol=1e-11, t_eval=np.linspace(37.0, 40.0, 301))
    found = response_to_ground(700.0, 420.0, AXLES, speed, np.array([frequency]))[0]
    assert path.y[0] == pytest.approx((found[0] * np.exp(1j * w * path.t)).imag, abs=1e-4)
    assert path.y[1] == pytest.approx((found[1] * np.exp(1j * w * path.t)).imag, abs=1e-4)


def test_roll_angle_balances_the_moment() -> None:
    roll = roll_motion(700.0, 220.0, 0.5, 1.624, AXLES)
    acceleration = 0.4
    angle = roll.flexibility * acceleration
    springs = sum(2 * (0.5 * axle.rate) * (0.5 * axle.track) ** 2 for axle in AXLES)
    assert springs * angle == pytest.approx(700.0 * 0.5 * (acceleration + 1.624 * angle))
    assert sum(roll.shares) == pytest.approx(1.0)
    assert roll.frequency > 0.0 and 0.0 < roll.damping < 1.0
    with pytest.raises(InvalidValueError, match="upright"):
        roll_motion(700.0, 220.0, 20.0, 9.81, AXLES)


def test_full_anti_dive_leaves_the_springs_alone() -> None:
    """The line from the contact to the instant centre passes through the height h at the other end, for all the
    force.
    """
    assert anti_fraction(1.0, 0.5, 2.5, wheelbase=2.5, height=0.5) == pytest.approx(1.0)
    assert pitch_under(-3.0, 1000.0, 2.5, 0.5, (3e4, 2.5e4), (1.0, 1.0)) == 0.0
    # without links the springs alone balance m a h
    angle = pitch_under(-3.0, 1000.0, 2.5, 0.5, (3e4, 3e4))
    assert angle < 0.0
    spring_moment = 2 * 3e4 * (1.25 * angle) * 1.25
    assert spring_moment == pytest.approx(-3.0 * 1000.0 * 0.5)
    assert pitch_under(-3.0, 1000.0, 2.5, 0.5, (3e4, 3e4), (0.3, 0.0)) > angle


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="spring"):
        undamped_modes(CAR._replace(spring=0.0))
    with pytest.raises(InvalidValueError, match="unsprung"):
        state_matrices(CAR._replace(unsprung=0.0))
    with pytest.raises(InvalidValueError, match="axles"):
        matrices(1.0, 1.0, AXLES[:1])
    with pytest.raises(InvalidValueError, match="run"):
        anti_fraction(0.5, 0.1, 0.0, 1.0, 1.0)
    with pytest.raises(InvalidValueError, match="force_share"):
        anti_fraction(1.5, 0.1, 1.0, 1.0, 1.0)
    with pytest.raises(InvalidValueError, match="speed"):
        first_nulls(1.0, 0.0)
