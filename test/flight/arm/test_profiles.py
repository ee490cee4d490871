"""Profiles: durations of the textbook, limits in every sample, derivatives that fit, joints that arrive together."""

import math

import numpy as np
import pytest
import ruckig
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.profiles import SHAPES, Shape, joint_motion, rest_to_rest
from sojourn_machine.errors import InvalidValueError

POSITIVE = st.floats(min_value=0.01, max_value=50.0)
VALIDATION = {"trapezoid": 2.5, "cubic": 3.0, "quintic": 3.75, "cycloidal": 4.0, "seven_segments": 2.7}


@pytest.mark.parametrize(("shape", "duration"), VALIDATION.items())
def test_durations_of_the_textbook(shape: Shape, duration: float) -> None:
    assert rest_to_rest(shape, 1.0, 0.5, 1.0, 5.0).duration == pytest.approx(duration, abs=1e-12)


def test_a_short_trapezoid_is_a_triangle() -> None:
    profile = rest_to_rest("trapezoid", 0.2, 0.5, 1.0)
    assert profile.duration == pytest.approx(2.0 * math.sqrt(0.2), abs=1e-12)
    assert profile.sample(0.5 * profile.duration)[1] == pytest.approx(math.sqrt(0.2))


def test_a_long_slow_way_with_hard_brakes_ends_at_rest() -> None:
    """4100 s of way and 0.2 ms of braking: the time's rounding is seen in the speed."""
    profile = rest_to_rest("trapezoid", 41.0, 0.01, 47.8828125)
    assert profile.sample(profile.duration)[1] == 0.0


@pytest.mark.parametrize("shape", SHAPES)
@given(distance=POSITIVE, speed=POSITIVE, acceleration=POSITIVE, jerk=POSITIVE)
@settings(max_examples=60, deadline=None)
def test_limits_hold_in_every_sample_and_derivatives_fit(
    shape: Shape, distance: float, speed: float, acceleration: float, jerk: float
) -> None:
    profile = rest_to_rest(shape, distance, speed, acceleration, jerk)
    times = np.linspace(0.0, profile.duration, 400)
    s, v, a = np.array([profile.sample(float(t)) for t in times]).T
    assert (s[0], v[0]) == (0.0, 0.0)
    assert s[-1] == pytest.approx(distance, rel=1e-9) and v[-1] == pytest.approx(0.0, abs=1e-8 * speed)
    assert np.all(v >= -1e-9 * speed) and np.all(v <= speed * (1 + 1e-9))
    assert np.all(np.abs(a) <= acceleration * (1 + 1e-9))
    dt = times[1]
    # the speed is the slope of the place: trapezoidal rule, wrong by at most the change of a
    np.testing.assert_allclose(np.diff(s), 0.5 * dt * (v[1:] + v[:-1]), atol=0.26 * dt**2 * 2 * acceleration + 1e-12)
    np.testing.assert_array_less(np.abs(np.diff(v)), acceleration * dt * (1 + 1e-6) + 1e-12)
    if shape == "seven_segments":
        np.testing.assert_array_less(np.abs(np.diff(a)), jerk * dt * (1 + 1e-6) + 1e-9 * acceleration)
    # something is at its limit, or the motion would not be the fastest of its shape
    used = [v.max() / speed, np.abs(a).max() / acceleration]
    if shape == "seven_segments":
        used.append(float(np.abs(np.diff(a)).max()) / dt / jerk)
    assert max(used) > 0.97


@given(distance=POSITIVE, speed=POSITIVE, acceleration=POSITIVE, jerk=POSITIVE)
@settings(max_examples=100, deadline=None)
def test_seven_segments_are_as_fast_as_ruckig(distance: float, speed: float, acceleration: float, jerk: float) -> None:
    problem = ruckig.InputParameter(1)
    problem.current_position, problem.target_position = [0.0], [distance]
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = [speed], [acceleration], [jerk]
    solution = ruckig.Trajectory(1)
    ruckig.Ruckig(1).calculate(problem, solution)
    profile = rest_to_rest("seven_segments", distance, speed, acceleration, jerk)
    assert profile.duration == pytest.approx(solution.duration, rel=1e-6)
    for share in (0.13, 0.4, 0.77):
        time = share * profile.duration
        assert profile.sample(time)[0] == pytest.approx(solution.at_time(time)[0][0], rel=1e-5, abs=1e-6 * distance)


@pytest.mark.parametrize("shape", SHAPES)
@given(seed=st.integers(min_value=0, max_value=2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_joints_move_together_within_their_limits(shape: Shape, seed: int) -> None:
    generator = np.random.default_rng(seed)
    start, goal = generator.uniform(-3, 3, 6), generator.uniform(-3, 3, 6)
    goal[2] = start[2]
    speed, acceleration, jerk = (generator.uniform(0.1, 4, 6) for _ in range(3))
    motion = joint_motion(shape, start, goal, speed, acceleration, jerk)
    for time in np.linspace(0.0, motion.duration, 100):
        q, qd, qdd = motion.sample(float(time))
        assert np.all(np.abs(qd) <= speed * (1 + 1e-9)) and np.all(np.abs(qdd) <= acceleration * (1 + 1e-9))
        moving = np.abs(goal - start) > 1e-12
        share = ((q - start) / np.where(moving, goal - start, 1.0))[moving]
        np.testing.assert_allclose(share, share[0], atol=1e-9)
        assert q[2] == start[2]
    np.testing.assert_allclose(motion.sample(motion.duration)[0], goal, atol=1e-9)


def test_nowhere_to_go_takes_no_time() -> None:
    here = np.ones(3)
    motion = joint_motion("quintic", here, here, here, here)
    assert motion.duration == 0.0
    np.testing.assert_array_equal(motion.sample(1.0)[0], here)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("cubic", 1.0, 0.0, 1.0), "speed limit of a cubic profile"),
        (("cubic", -1.0, 1.0, 1.0), "distance of a cubic profile"),
        (("trapezoid", 1.0, 1.0, math.nan), "acceleration limit"),
        (("seven_segments", 1.0, 1.0, 1.0), "jerk limit"),
        (("quintic", math.inf, 1.0, 1.0), "distance"),
    ],
)
def test_wrong_limits_are_refused(arguments: tuple[Shape, float, float, float], words: str) -> None:
    with pytest.raises(InvalidValueError, match=words):
        rest_to_rest(*arguments)
