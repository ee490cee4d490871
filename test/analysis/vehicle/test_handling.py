"""Linear handling: closed forms of two axles, poles against the response, and the linear against the non-linear
model.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_analysis.vehicle.cornering import (
    CorneringAxle,
    CorneringVehicle,
    accelerations,
    simulate,
    steady_cornering,
    wheel_forces,
)
from sojourn_analysis.vehicle.handling import (
    SingleTrack,
    characteristic_speed,
    critical_speed,
    frequency_response,
    neutral_steer_point,
    poles,
    state_matrices,
    steady_gains,
    step_response,
    understeer_gradient,
)
from sojourn_analysis.vehicle.side_force import (
    FirmSideForce,
    LinearSideForce,
    SoilSideForce,
    cornering_stiffness,
)
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams

CAR = SingleTrack(1200.0, 1800.0, (1.1, -1.4), (60e3, 55e3), (1.0, 0.0))
LOOSE = SingleTrack(1200.0, 1800.0, (1.4, -1.1), (60e3, 55e3), (1.0, 0.0))


def test_understeer_gradient_of_two_axles() -> None:
    assert understeer_gradient(CAR) == pytest.approx(1200.0 / 2.5**2 * (1.4 / 60e3 - 1.1 / 55e3))
    assert (neutral_steer_point(CAR) < 0.0) == (understeer_gradient(CAR) > 0.0)


@given(speed=st.floats(1.0, 60.0))
def test_gains_are_the_closed_forms(speed: float) -> None:
    gains = steady_gains(CAR, speed)
    under = 1.0 + understeer_gradient(CAR) * speed**2
    assert gains.curvature == pytest.approx(1.0 / (2.5 * under))
    assert gains.lateral_acceleration == pytest.approx(speed**2 / (2.5 * under))
    assert gains.side_slip == pytest.approx(1.4 / 2.5 * (1.0 - 1200.0 * 1.1 * speed**2 / (1.4 * 2.5 * 55e3)) / under)


@given(front=st.floats(2e4, 9e4), rear=st.floats(2e4, 9e4))
def test_a_pole_crosses_at_the_critical_speed(front: float, rear: float) -> None:
    car = LOOSE._replace(stiffness=(front, rear))
    critical = critical_speed(car)
    if math.isinf(critical) or critical > 1e3:
        assert poles(car, 60.0).real.max() < 0.0 or critical > 60.0
        return
    assert poles(car, 0.99 * critical).real.max() < 0.0 < poles(car, 1.01 * critical).real.max()


def test_characteristic_speed_halves_the_curvature_gain() -> None:
    speed = characteristic_speed(CAR)
    assert steady_gains(CAR, speed).curvature == pytest.approx(0.5 / 2.5)
    assert math.isinf(characteristic_speed(LOOSE)) and math.isinf(critical_speed(CAR))


def test_step_response_is_the_integral() -> None:
    a, b = state_matrices(CAR, 20.0)
    times = np.linspace(0.0, 3.0, 13)
    path = solve_ivp(lambda t, s: a @ s + b[:, 0] * 0.02, (0.0, 3.0), [0.0, 0.0], t_eval=times, rtol=1e-10, atol=1e-13)
    found = step_response(CAR, 20.0, 0.02, times)
    assert found == pytest.approx(path.y.T, abs=1e-9)
    last = step_response(CAR, 20.0, 0.02, np.array([60.0]))[0]
    assert last[1] == pytest.approx(0.02 * steady_gains(CAR, 20.0).yaw_rate)


def test_frequency_response_begins_at_the_steady_gain() -> None:
    found = frequency_response(CAR, 20.0, np.array([1e-6, 1.0]))
    assert abs(found[0, 1]) == pytest.approx(steady_gains(CAR, 20.0).yaw_rate)
    assert abs(found[1, 1]) < abs(found[0, 1]) * 1.5


def test_an_axle_split_in_two_changes_nothing() -> None:
    split = SingleTrack(1200.0, 1800.0, (1.1, 1.1, -1.4), (20e3, 40e3, 55e3), (1.0, 1.0, 0.0))
    assert sorted(poles(split, 15.0)) == pytest.approx(sorted(poles(CAR, 15.0)))
    assert steady_gains(split, 15.0) == pytest.approx(steady_gains(CAR, 15.0))


def four_wheels(law: object, height: float = 0.0) -> CorneringVehicle:
    weight = 1200.0 * 9.81
    return CorneringVehicle(
        1200.0,
        1800.0,
        height,
        (
            CorneringAxle(1.1, 1.4, weight * 1.4 / 2.5, 1.0, 0.5, law),
            CorneringAxle(-1.4, 1.4, weight * 1.1 / 2.5, 0.0, 0.5, law),
        ),
    )


def test_non_linear_model_is_the_linear_one_for_small_angles() -> None:
    law = LinearSideForce(28e3)
    car = SingleTrack(1200.0, 1800.0, (1.1, -1.4), (56e3, 56e3), (1.0, 0.0))
    times = np.linspace(0.0, 4.0, 21)
    path = simulate(four_wheels(law), 15.0, lambda t: 1e-3, times)
    linear = step_response(car, 15.0, 1e-3, times)
    assert path[:, 4] == pytest.approx(linear[:, 1], abs=2e-3 * abs(linear[-1, 1]))
    assert path[:, 3] / 15.0 == pytest.approx(linear[:, 0], abs=2e-3 * np.abs(linear[:, 0]).max())


def test_steady_cornering_is_where_the_simulation_ends() -> None:
    vehicle = four_wheels(FirmSideForce(0.8, 9.0), height=0.5)
    path = simulate(vehicle, 12.0, lambda t: 0.06, np.array([0.0, 10.0]))
    side, rate = steady_cornering(vehicle, 12.0, 0.06)
    assert (side, rate) == (pytest.approx(path[-1, 3], rel=1e-4), pytest.approx(path[-1, 4], rel=1e-4))
    assert accelerations(vehicle, 12.0, side, rate, 0.06) == pytest.approx((0.0, 0.0), abs=1e-8)
    rows = wheel_forces(vehicle, 12.0, side, rate, 0.06)
    assert rows[:, 3].sum() == pytest.approx(1200.0 * 9.81)
    assert rows[1, 3] > rows[0, 3]  # a left turn loads the right wheels


def test_no_more_side_force_than_friction() -> None:
    vehicle = four_wheels(FirmSideForce(0.5, 9.0), height=0.5)
    times = np.linspace(0.0, 6.0, 61)
    path = simulate(vehicle, 20.0, lambda t: 0.3, times)
    curvature_demand = 20.0**2 / (2.5 / math.tan(0.3))
    acceleration = np.gradient(path[:, 3], times) + 20.0 * path[:, 4]
    assert curvature_demand > 0.5 * 9.81
    assert np.abs(acceleration[5:]).max() < 0.5 * 9.81 * 1.02


@given(angle=st.floats(-1.2, 1.2), load=st.floats(10.0, 1000.0))
def test_side_forces_oppose_the_slip(angle: float, load: float) -> None:
    force = FirmSideForce(0.7, 8.0).force(load, angle)
    assert force * angle <= 0.0
    assert abs(force) <= 0.7 * load * (1.0 + 1e-12)
    assert FirmSideForce(0.7, 8.0).force(load, -angle) == pytest.approx(-force)


def test_side_force_of_soil(lunar_soil: SoilParams) -> None:
    law = SoilSideForce(lunar_soil, WheelShape(name="lrv", citation="test", radius=0.4065, width=0.229), 1.624)
    stiffness = cornering_stiffness(law, 284.0)
    assert stiffness > 0.0
    assert law.force(284.0, 0.02) == pytest.approx(-0.02 * stiffness, rel=0.15)
    assert law.force(284.0, 0.3) == pytest.approx(-law.force(284.0, -0.3))
    most = 284.0 * math.tan(lunar_soil.friction_angle) + 0.3 * 0.229 * lunar_soil.cohesion
    assert -law.force(284.0, 1.2) < most * 1.5
    assert cornering_stiffness(FirmSideForce(0.7, 8.0), 100.0) == pytest.approx(800.0, rel=1e-2)


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="speed"):
        poles(CAR, 0.0)
    with pytest.raises(InvalidValueError, match="stiffness"):
        poles(CAR._replace(stiffness=(1.0, -1.0)), 1.0)
    with pytest.raises(InvalidValueError, match="an axle"):
        poles(CAR._replace(x=(1.0,)), 1.0)
    with pytest.raises(InvalidValueError, match="critical"):
        steady_gains(LOOSE, critical_speed(LOOSE))
    with pytest.raises(InvalidValueError, match="speed"):
        simulate(four_wheels(LinearSideForce(1.0)), 0.0, lambda t: 0.0, np.array([0.0, 1.0]))
