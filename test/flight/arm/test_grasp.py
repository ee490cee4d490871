"""Grasps with answers in closed form, and what must hold of any."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.grasp import Finger, holds, needed_force
from sojourn_machine.errors import InvalidValueError

ZERO = np.zeros(3)


def jaws(friction: float, torsion: float = 0.0, half: float = 0.03) -> list[Finger]:
    """Two fingers that face each other along y."""
    return [
        Finger(np.array([0.0, half, 0.0]), np.array([0.0, -1.0, 0.0]), friction, torsion),
        Finger(np.array([0.0, -half, 0.0]), np.array([0.0, 1.0, 0.0]), friction, torsion),
    ]


def load(*force: float, moment: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    return np.array([*force, *moment])


@pytest.mark.parametrize("friction", [0.2, 0.5, 0.9])
def test_two_jaws_carry_a_weight_by_friction(friction: float) -> None:
    """N = m g/(2 μ)."""
    weight = 1.5 * 1.62
    down, needed = load(0.0, 0.0, -weight), weight / (2.0 * friction)
    assert needed_force(jaws(friction), ZERO, down) == pytest.approx(needed, rel=1e-6)
    assert holds(jaws(friction), ZERO, down, 1.01 * needed)
    assert not holds(jaws(friction), ZERO, down, 0.99 * needed)


def test_a_load_along_the_jaws_needs_no_friction() -> None:
    assert needed_force(jaws(0.0), ZERO, load(0.0, 3.0, 0.0)) == pytest.approx(3.0)
    assert math.isinf(needed_force(jaws(0.0), ZERO, load(0.0, 0.0, -1.0)))


def test_point_fingers_let_it_turn_and_soft_ones_do_not() -> None:
    """A centre of mass beside the line of the jaws turns the object about it: m g x <= 2 γ N."""
    torque = load(0.0, 0.0, 0.0, moment=(0.0, 0.02, 0.0))
    assert math.isinf(needed_force(jaws(0.5), ZERO, torque))
    assert needed_force(jaws(0.5, torsion=0.004), ZERO, torque) == pytest.approx(0.02 / (2 * 0.004), rel=1e-6)


def test_an_object_on_an_inclined_palm_slides_beyond_the_friction_angle() -> None:
    for degrees, friction, stays in ((20.0, 0.4, True), (25.0, 0.4, False)):
        angle = math.radians(degrees)
        down = np.array([0.0, math.sin(angle), -math.cos(angle)])
        palm = [
            Finger(np.array([x, y, 0.0]), np.array([0.0, 0.0, 1.0]), friction)
            for x, y in ((0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1))
        ]
        assert math.isfinite(needed_force(palm, ZERO, load(*down))) == stays


@settings(max_examples=40, deadline=None)
@given(
    st.floats(0.1, 1.0),
    st.floats(0.05, 0.9),
    st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3),
    st.floats(0.1, 10.0),
)
def test_more_friction_needs_less_force_and_force_goes_with_load(
    friction: float, more: float, force: list[float], factor: float
) -> None:
    base = needed_force(jaws(friction, 0.01), ZERO, load(*force))
    assert needed_force(jaws(friction + more, 0.01), ZERO, load(*force)) <= base * (1.0 + 1e-6) + 1e-9
    scaled = needed_force(jaws(friction, 0.01), ZERO, factor * load(*force))
    assert scaled == pytest.approx(factor * base, rel=1e-5, abs=1e-7)
    # never less than the round cone asks for, and little more
    along, across = abs(force[1]), math.hypot(force[0], force[2])
    exact = along + across / (2.0 * friction)
    assert exact * (1.0 - 1e-6) - 1e-7 <= base <= exact / math.cos(math.pi / 32) * (1.0 + 1e-6) + 1e-7


def test_what_is_no_grasp_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="fingers"):
        needed_force([], ZERO, load(0.0, 0.0, 1.0))
    with pytest.raises(InvalidValueError, match="normal"):
        needed_force([Finger(ZERO, ZERO, 0.5)], ZERO, load(0.0, 0.0, 1.0))
    with pytest.raises(InvalidValueError, match="friction"):
        needed_force([Finger(ZERO, np.ones(3), -0.5)], ZERO, load(0.0, 0.0, 1.0))
    with pytest.raises(InvalidValueError, match="finite"):
        needed_force(jaws(0.5), ZERO, load(math.nan, 0.0, 1.0))
