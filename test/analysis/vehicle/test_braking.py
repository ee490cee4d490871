"""Braking against simulation, coasting against integration, and the ideal distribution against any other."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_analysis.vehicle.braking import (
    BrakeGeometry,
    braking_limit,
    coasting_speed,
    dynamic_loads,
    ideal_forces,
    ideal_front_fraction,
    stopping_distance,
)
from sojourn_machine.errors import InvalidValueError

CAR = BrakeGeometry(front=1.1, rear=1.3, height=0.5, mass=1000.0, gravity=9.81)


@given(friction=st.floats(0.1, 1.0), fraction=st.floats(0.05, 0.95))
def test_limit_is_where_one_axle_uses_all_friction(friction: float, fraction: float) -> None:
    limit = braking_limit(CAR, friction, fraction)
    force = CAR.mass * limit.deceleration
    front, rear = dynamic_loads(CAR, limit.deceleration)
    use = (fraction * force / front, (1.0 - fraction) * force / rear)
    assert max(use) == pytest.approx(friction)
    assert limit.efficiency <= 1.0 + 1e-9
    if limit.first_to_lock != "both":
        assert (limit.first_to_lock == "front") == (use[0] > use[1])


@given(deceleration=st.floats(0.5, 9.0))
def test_ideal_distribution_reaches_all_the_friction(deceleration: float) -> None:
    front, rear = ideal_forces(CAR, deceleration)
    assert front + rear == pytest.approx(CAR.mass * deceleration)
    fraction = ideal_front_fraction(CAR, deceleration)
    assert front / (front + rear) == pytest.approx(fraction)
    assert braking_limit(CAR, deceleration / CAR.gravity, fraction).efficiency == pytest.approx(1.0)


@pytest.mark.parametrize(("constant", "quadratic"), [(0.02, 0.0), (0.0, 1e-3), (0.03, 2e-3)])
def test_coasting_by_integration(constant: float, quadratic: float) -> None:
    rate = 1.62 / 1.1
    path = solve_ivp(lambda t, v: -rate * (constant + quadratic * v * v), (0.0, 20.0), [3.0], rtol=1e-10, atol=1e-12)
    assert coasting_speed(3.0, 20.0, 1.62, constant, quadratic, 1.1) == pytest.approx(path.y[0, -1], rel=1e-7)
    assert coasting_speed(3.0, 1e4, 1.62, constant, quadratic, 1.1) == pytest.approx(0.0, abs=0.1)


def test_stopping_distance_by_the_work() -> None:
    assert stopping_distance(3.0, 0.5, 1.0) == pytest.approx(3.0 + 0.5 * 9.0 / 0.5)


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="lifts"):
        dynamic_loads(CAR, 30.0)
    with pytest.raises(InvalidValueError, match="friction"):
        braking_limit(CAR, 0.0, 0.5)
    with pytest.raises(InvalidValueError, match="fraction"):
        braking_limit(CAR, 0.5, 1.5)
    with pytest.raises(InvalidValueError, match="deceleration"):
        stopping_distance(1.0, 0.0)
    with pytest.raises(InvalidValueError, match="mass_ratio"):
        coasting_speed(1.0, 1.0, 1.0, 0.1, 0.0, 0.5)
