"""Timing of paths: limits of speed, acceleration, torque and power in every sample, and nothing given away."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictionless import no_friction
from sojourn_config.arms import load_arm
from sojourn_flight.arm.serial_arm import SerialArm, with_motors
from sojourn_flight.arm.spline_path import SplinePath, chord_length, spline_through
from sojourn_flight.arm.time_optimal import JointLimits, TimingError, fastest_timing, largest_share
from sojourn_machine.errors import InvalidValueError

EARTH = np.array([0.0, 0.0, -9.81])
PUMA, GANTRY = load_arm("puma560"), load_arm("cartesian")


def _limits(arm: SerialArm, acceleration: float = 5.0, power: float = math.inf) -> JointLimits:
    return JointLimits(arm.max_velocity, np.full(arm.joint_count, acceleration), arm.max_effort, power, 0.7)


def _path(arm: SerialArm, generator: np.random.Generator, count: int) -> SplinePath:
    middle, half = 0.5 * (arm.lower + arm.upper), 0.25 * (arm.upper - arm.lower)
    points = generator.uniform(middle - half, middle + half, (count, arm.joint_count))
    return spline_through(points, chord_length(points, 0.5 * (arm.upper - arm.lower)))


@pytest.mark.parametrize("power", [math.inf, 60.0])
@given(seed=st.integers(min_value=0, max_value=2**32 - 1))
@settings(max_examples=6, deadline=None)
def test_every_limit_holds_in_every_sample(power: float, seed: int) -> None:
    generator = np.random.default_rng(seed)
    path, limits = _path(PUMA, generator, int(generator.integers(2, 6))), _limits(PUMA, power=power)
    motion = fastest_timing(PUMA, path, limits, EARTH)
    times = generator.uniform(0.0, motion.duration, 400)
    assert largest_share(PUMA, motion, limits, EARTH, times) <= 1.005
    first, last = motion.sample(0.0), motion.sample(motion.duration)
    np.testing.assert_allclose(first[0], path.at(0.0)[0], atol=1e-12)
    np.testing.assert_allclose(last[0], path.at(path.end)[0], atol=1e-9)
    assert np.all(first[1] == 0.0) and np.all(np.abs(last[1]) < 1e-6)
    # nearly always something is at its limit
    busy = [largest_share(PUMA, motion, limits, EARTH, np.array([t])) for t in times[:150]]
    assert float(np.median(busy)) > 0.93


def test_one_free_axis_is_bang_bang() -> None:
    """A slide under a force limit alone: half the way with all of it, half against it, T = 2 sqrt(D m/F)."""
    free = with_motors(GANTRY, GANTRY.motor_inertia, no_friction(3))
    mass = 18.0 + 8.0 + 3.0 + float(free.motor_inertia[0])
    points = np.array([[0.1, 0.3, 0.2], [0.6, 0.3, 0.2], [1.1, 0.3, 0.2]])
    path = spline_through(points, np.array([0.0, 0.5, 1.0]))
    effort = np.array([50.0, 1e4, 1e4])
    limits = JointLimits(np.full(3, 1e3), np.full(3, 1e6), effort)
    motion = fastest_timing(free, path, limits, EARTH)
    assert motion.duration == pytest.approx(2.0 * math.sqrt(1.0 * mass / 50.0), rel=2e-3)
    # with friction the slide starts more slowly and brakes faster
    sliding, force = float(GANTRY.friction.forward[0]), 50.0
    rubbed = fastest_timing(
        with_motors(GANTRY, GANTRY.motor_inertia, _coulomb_only(GANTRY)), path, limits, EARTH
    ).duration
    up, down = (force - sliding) / mass, (force + sliding) / mass
    assert rubbed == pytest.approx(math.sqrt(2.0 * (1 / up + 1 / down)), rel=2e-3)


def _coulomb_only(arm: SerialArm):  # type: ignore[no-untyped-def]
    from dataclasses import replace

    return replace(arm.friction, viscous=np.zeros(arm.joint_count))


def test_speed_and_acceleration_alone_give_the_trapezoid() -> None:
    points = np.linspace([0.1, 0.1, 0.2], [1.1, 0.1, 0.2], 3)
    path = spline_through(points, np.array([0.0, 0.5, 1.0]))
    limits = JointLimits(np.full(3, 0.5), np.ones(3), np.full(3, 1e6))
    assert fastest_timing(GANTRY, path, limits, np.zeros(3)).duration == pytest.approx(2.5, rel=2e-3)


def test_a_lift_at_a_power_limit_takes_the_work_over_the_power() -> None:
    """Slow and long: the time is what the weight, the friction and the efficiency make of the watts."""
    points = np.linspace([0.1, 0.1, 0.5], [0.1, 0.1, 0.1], 3)  # the z joint counts downward
    path = spline_through(points, np.array([0.0, 0.2, 0.4]))
    free = with_motors(GANTRY, GANTRY.motor_inertia, _coulomb_only(GANTRY))
    limits = JointLimits(np.full(3, 10.0), np.full(3, 10.0), np.full(3, 1e5), 2.0, 0.6)
    force = 3.0 * 9.81 + float(GANTRY.friction.backward[2])
    assert fastest_timing(free, path, limits, EARTH).duration == pytest.approx(force * 0.4 / (0.6 * 2.0), rel=0.02)


def test_less_power_takes_longer() -> None:
    path = _path(PUMA, np.random.default_rng(4), 4)
    durations = [fastest_timing(PUMA, path, _limits(PUMA, power=watts), EARTH).duration for watts in (400, 100, 40)]
    assert durations[0] < durations[1] < durations[2]


def test_an_arm_that_cannot_hold_itself_is_told_where() -> None:
    weak = JointLimits(PUMA.max_velocity, np.full(6, 5.0), np.full(6, 20.0))
    stretched = np.array([[0.0, 0.1, -1.5, 0.0, 0.0, 0.0], [0.5, 0.2, -1.5, 0.0, 0.0, 0.0]])
    path = spline_through(stretched, np.array([0.0, 1.0]))
    with pytest.raises(TimingError, match=r"at \d+ % of the path the limits of effort or power are too small"):
        fastest_timing(PUMA, path, weak, EARTH)
    with pytest.raises(InvalidValueError, match="power limit"):
        fastest_timing(PUMA, path, _limits(PUMA, power=-1.0), EARTH)


def test_extremes_of_a_spline_are_exact() -> None:
    path = _path(PUMA, np.random.default_rng(7), 6)
    low, high = path.extremes()
    fine = path.at(np.linspace(0.0, path.end, 20_001))[0]
    np.testing.assert_allclose(low, fine.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(high, fine.max(axis=0), atol=1e-6)
    with pytest.raises(InvalidValueError, match="points of a path"):
        spline_through(np.zeros((3, 2)), np.zeros(3))
