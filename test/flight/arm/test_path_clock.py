"""Pause, go on and stop at any moment: on the path, within the limits, and to the end."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sojourn_config.arms import load_arm
from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.path_clock import ClockLimits, PathClock, advance, sample
from sojourn_flight.arm.profiles import SHAPES, TimedPath, joint_motion
from sojourn_flight.arm.spline_path import chord_length, spline_through
from sojourn_flight.arm.time_optimal import JointLimits, fastest_timing
from sojourn_flight.arm.trajectory import at_rest, point_to_point

DT = 0.02
PUMA = load_arm("puma560")
SCENARIO = load_scenario("flat_drive")
EXPLORER = build_arm_model(SCENARIO.urdf_xml, SCENARIO.carried_arm())
ACCELERATION, JERK = np.full(6, 2.0), np.full(6, 20.0)
LIMITS = ClockLimits(ACCELERATION, np.full(6, np.inf))
"""Of motions whose acceleration jumps."""


def _motion(seed: int) -> TimedPath:
    generator = np.random.default_rng(seed)
    middle, half = 0.5 * (PUMA.lower + PUMA.upper), 0.25 * (PUMA.upper - PUMA.lower)
    points = generator.uniform(middle - half, middle + half, (4, 6))
    if seed % 2:
        shape = SHAPES[seed % len(SHAPES)]
        return joint_motion(shape, points[0], points[1], PUMA.max_velocity, ACCELERATION, np.full(6, 20.0))
    path = spline_through(points, chord_length(points, half))
    limits = JointLimits(PUMA.max_velocity, 0.995 * ACCELERATION, np.full(6, 1e4))
    return fastest_timing(PUMA, path, limits, np.zeros(3))


@given(seed=st.integers(min_value=0, max_value=2**32 - 1))
@settings(max_examples=5, deadline=None)
def test_limits_hold_whatever_is_asked_for(seed: int) -> None:
    generator = np.random.default_rng(seed)
    motion, clock = _motion(seed), PathClock()
    before = motion.sample(0.0)[0]
    speed_before = np.zeros(6)
    wanted, left = 1.0, 40
    for _ in range(500):
        if left == 0:
            wanted, left = float(generator.choice([0.0, 0.0, 1.0, 1.0, 0.4])), int(generator.integers(5, 60))
        left -= 1
        clock = advance(motion, clock, wanted, LIMITS, DT)
        q, qd, qdd = sample(motion, clock)
        assert np.all(np.abs(qd) <= PUMA.max_velocity * 1.006)
        assert np.all(np.abs(qdd) <= ACCELERATION * 1.001)
        # what a drive would see: differences of the samples
        np.testing.assert_allclose(q - before, 0.5 * DT * (qd + speed_before), atol=1.01 * DT**2 * ACCELERATION[0])
        assert np.all(np.abs(qd - speed_before) <= 1.02 * ACCELERATION * DT + 1e-9)
        before, speed_before = q, qd
        if clock.time >= motion.duration:
            break


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_a_pause_stands_on_the_path_and_the_rest_follows(seed: int) -> None:
    motion, clock = _motion(seed), PathClock()
    while clock.time < 0.4 * motion.duration:
        clock = advance(motion, clock, 1.0, LIMITS, DT)
    paused_at = clock.time
    for _ in range(400):
        clock = advance(motion, clock, 0.0, LIMITS, DT)
    assert clock.rate == 0.0 and clock.time < motion.duration
    assert paused_at <= clock.time < paused_at + 3.0
    q, qd, qdd = sample(motion, clock)
    np.testing.assert_array_equal(q, motion.sample(clock.time)[0])
    assert np.all(qd == 0.0) and np.all(qdd == 0.0)
    for _ in range(2000):
        clock = advance(motion, clock, 1.0, LIMITS, DT)
    np.testing.assert_allclose(sample(motion, clock)[0], motion.sample(motion.duration)[0], atol=1e-9)


def test_running_undisturbed_takes_the_planned_time_and_the_start() -> None:
    motion, clock, periods = _motion(2), PathClock(), 0
    while clock.time < motion.duration:
        clock = advance(motion, clock, 1.0, LIMITS, DT)
        periods += 1
    assert periods * DT < motion.duration + 0.6  # the clock itself has to start


@given(seed=st.integers(min_value=0, max_value=2**32 - 1))
@example(26150606)  # told to pause while it went back to full speed, it was led beyond that, and cut off there
@settings(max_examples=8, deadline=None)
def test_jerk_too_is_within_the_limits_whatever_is_asked_for(seed: int) -> None:
    """The commands' third differences; the change of the rate used to be a step of acceleration."""
    generator = np.random.default_rng(seed)
    start, end = (generator.uniform(EXPLORER.lower, EXPLORER.upper) for _ in range(2))
    motion = point_to_point(EXPLORER, at_rest(start), end)
    limits = ClockLimits(EXPLORER.max_acceleration, EXPLORER.max_jerk)
    clock, commands, wanted, left = PathClock(), [start] * 4, 1.0, 60
    for _ in range(4000):
        if left == 0:
            wanted, left = float(generator.choice([0.0, 0.3, 1.0, 1.0])), int(generator.integers(5, 80))
        left -= 1
        clock = advance(motion, clock, wanted, limits, DT)
        commands.append(sample(motion, clock)[0])
        if clock.time >= motion.duration:
            break
    assert clock.time >= motion.duration
    commands += [end] * 4
    for order, limit in ((1, EXPLORER.max_velocity), (2, EXPLORER.max_acceleration), (3, EXPLORER.max_jerk)):
        assert np.all(np.abs(np.diff(commands, order, axis=0)) / DT**order <= limit * (1.0 + 1e-4))


def test_a_stop_takes_little_longer_than_the_quickest_within_the_limits() -> None:
    start = np.array([0.0, -1.0, 1.9, -0.9, 0.0])
    motion = point_to_point(EXPLORER, at_rest(start), start + np.array([1.0, 0.0, 0.0, 0.0, 0.0]))
    limits = ClockLimits(EXPLORER.max_acceleration, EXPLORER.max_jerk)
    clock, periods = PathClock(time=0.5 * motion.duration, rate=1.0), 0
    while clock.rate > 0.0:
        clock = advance(motion, clock, 0.0, limits, DT)
        periods += 1
    speed, acceleration, jerk = EXPLORER.max_velocity[0], EXPLORER.max_acceleration[0], EXPLORER.max_jerk[0]
    assert (
        speed / acceleration + acceleration / jerk <= periods * DT <= 1.1 * (speed / acceleration + acceleration / jerk)
    )
