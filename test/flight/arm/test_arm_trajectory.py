"""Jerk-limited motions: closed-form times, limits in every sample, continuity from any state."""

import copy
import dataclasses
from typing import Any

import numpy as np
import pytest
import ruckig
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.trajectory import (
    JointReference,
    TrajectoryError,
    at_rest,
    check_limits,
    point_to_point,
    stop,
    through_points,
)

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)


def _with_limits(model: Any, speed: float, acceleration: float, jerk: float) -> Any:
    n = model.joint_count
    return dataclasses.replace(
        model,
        max_velocity=np.full(n, speed),
        max_acceleration=np.full(n, acceleration),
        max_jerk=np.full(n, jerk),
    )


def _sampled(path: JointPath, step: float = 0.002) -> tuple[Any, Any, Any, Any]:
    times = np.append(np.arange(0.0, path.duration, step), path.duration)
    rows = [path.sample(t) for t in times]
    return times, *(np.array([row[k] for row in rows]) for k in range(3))


def _assert_within_limits(model: Any, path: JointPath) -> None:
    times, position, velocity, acceleration = _sampled(path)
    assert np.all(position >= model.lower - 1e-6) and np.all(position <= model.upper + 1e-6)
    assert np.all(np.abs(velocity) <= model.max_velocity * (1.0 + 1e-6))
    assert np.all(np.abs(acceleration) <= model.max_acceleration * (1.0 + 1e-6))
    spans = np.diff(times)[:, None]
    spans = np.where(spans > 1e-6, spans, np.inf)
    assert np.all(np.abs(np.diff(acceleration, axis=0)) / spans <= model.max_jerk * (1.0 + 1e-4))
    # The samples of one quantity are the integrals of the next (trapezium rule, jerk bounds its error).
    drift = np.diff(position, axis=0) - 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(times)[:, None]
    # Ruckig ends a motion to 1e-8 rad; the path closes that gap at its end.
    assert np.all(np.abs(drift) <= model.max_jerk * 0.002**3 + 2e-8)
    drift = np.diff(velocity, axis=0) - 0.5 * (acceleration[1:] + acceleration[:-1]) * np.diff(times)[:, None]
    assert np.all(np.abs(drift) <= model.max_jerk * 0.002**2)


def _moving_state(arm: Any, generator: np.random.Generator) -> JointReference:
    """A state that the arm passes through on its way between two postures."""
    path = point_to_point(arm.model, at_rest(arm.random_posture(generator)), arm.random_posture(generator))
    return JointReference(*path.sample(generator.uniform(0.0, path.duration)))


@pytest.mark.published("closed forms of trapezoid, triangle and seven segments")
@pytest.mark.parametrize(
    ("distance", "jerk", "duration", "tolerance"),
    [
        # dq/v + v/a + a/J when speed and acceleration limits are reached
        (1.0, 5.0, 2.7, 1e-9),
        # J large: the trapezoid dq/v + v/a, and the triangle 2 sqrt(dq/a)
        (1.0, 1.0e4, 2.5, 2e-4),
        (0.2, 1.0e4, 0.8944, 2e-4),
    ],
)
def test_published_durations(small: Any, distance: float, jerk: float, duration: float, tolerance: float) -> None:
    model = _with_limits(small.model, 0.5, 1.0, jerk)
    path = point_to_point(model, at_rest(np.zeros(5)), np.array([distance, 0.0, 0.0, 0.0, 0.0]))
    assert path.duration == pytest.approx(duration, abs=tolerance)


def test_from_rest_all_joints_move_on_one_line(small: Any) -> None:
    target = np.array([1.0, -0.4, 0.7, 0.2, -1.1])
    path = point_to_point(small.model, at_rest(np.zeros(5)), target)
    for t in np.linspace(0.0, path.duration, 50):
        position = path.sample(t)[0]
        np.testing.assert_allclose(position, target * (position[0] / target[0]), atol=1e-9)


@given(seed=SEEDS)
@settings(max_examples=40, deadline=None)
def test_limits_hold_in_every_sample_between_random_postures(small: Any, explorer: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    for arm in (small, explorer):
        start, target = arm.random_posture(generator), arm.random_posture(generator)
        path = point_to_point(arm.model, at_rest(start), target)
        _assert_within_limits(arm.model, path)
        np.testing.assert_allclose(path.sample(0.0)[0], start, atol=1e-12)
        np.testing.assert_allclose(path.sample(path.duration)[0], target, atol=1e-9)


@given(seed=SEEDS)
@settings(max_examples=60, deadline=None)
def test_a_new_target_is_taken_up_from_any_state_of_motion(small: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    start, target = _moving_state(small, generator), small.random_posture(generator)
    path = point_to_point(small.model, start, target)
    first = path.sample(0.0)
    np.testing.assert_allclose(first[0], start.position, atol=1e-9)
    np.testing.assert_allclose(first[1], start.velocity, atol=1e-7)
    np.testing.assert_allclose(first[2], start.acceleration, atol=1e-6)
    _assert_within_limits(small.model, path)
    last = path.sample(path.duration)
    np.testing.assert_allclose(last[0], target, atol=1e-8)
    np.testing.assert_allclose(last[1], 0.0, atol=1e-8)


@given(seed=SEEDS)
@settings(max_examples=40, deadline=None)
def test_a_stop_ends_at_rest_within_the_limits(small: Any, seed: int) -> None:
    start = _moving_state(small, np.random.default_rng(seed))
    path = stop(small.model, start)
    _assert_within_limits(small.model, path)
    np.testing.assert_allclose(path.sample(path.duration)[1], 0.0, atol=1e-9)
    np.testing.assert_allclose(path.sample(path.duration)[2], 0.0, atol=1e-9)
    # Never longer than the closed form from full speed and worst acceleration: a/J + (v + a^2/2J)/a + a/J.
    v, a, j = small.model.max_velocity, small.model.max_acceleration, small.model.max_jerk
    assert path.duration <= float(np.max(2.0 * a / j + (v + a * a / (2.0 * j)) / a))


def test_copy_of_a_solution_equals_the_library(small: Any) -> None:
    generator = np.random.default_rng(5)
    n = 5
    for _ in range(20):
        start, target = _moving_state(small, generator), small.random_posture(generator)
        problem = ruckig.InputParameter(n)
        problem.synchronization = ruckig.Synchronization.Phase
        problem.current_position = start.position.tolist()
        problem.current_velocity = start.velocity.tolist()
        problem.current_acceleration = start.acceleration.tolist()
        problem.target_position = target.tolist()
        problem.max_velocity = small.model.max_velocity.tolist()
        problem.max_acceleration = small.model.max_acceleration.tolist()
        problem.max_jerk = small.model.max_jerk.tolist()
        solution = ruckig.Trajectory(n)
        ruckig.Ruckig(n).calculate(problem, solution)
        path = point_to_point(small.model, start, target)
        if path.duration > solution.duration + 1e-9:
            continue  # replaced by a stop and a motion from rest, because it would swing past a limit
        for t in np.linspace(0.0, path.duration, 40):
            for mine, theirs in zip(path.sample(t), solution.at_time(t), strict=True):
                np.testing.assert_allclose(mine, theirs, atol=1e-9)


def test_extremes_are_those_of_dense_samples(small: Any) -> None:
    generator = np.random.default_rng(6)
    for _ in range(10):
        path = point_to_point(small.model, _moving_state(small, generator), small.random_posture(generator))
        low, high, speed, acceleration, jerk = path.extremes()
        _, q, qd, qdd = _sampled(path, 0.0005)
        np.testing.assert_allclose(low, q.min(axis=0), atol=1e-6)
        np.testing.assert_allclose(high, q.max(axis=0), atol=1e-6)
        np.testing.assert_allclose(speed, np.abs(qd).max(axis=0), atol=2e-6)
        np.testing.assert_allclose(acceleration, np.abs(qdd).max(axis=0), atol=5e-3)
        assert np.all(jerk <= small.model.max_jerk * (1.0 + 1e-9))


def test_a_path_is_a_plain_value(small: Any) -> None:
    path = point_to_point(small.model, at_rest(np.zeros(5)), np.full(5, 0.3))
    twin = copy.deepcopy(path)
    assert twin is not path
    np.testing.assert_array_equal(twin.sample(0.4)[0], path.sample(0.4)[0])


def test_a_limit_that_is_broken_is_named(small: Any) -> None:
    path = point_to_point(small.model, at_rest(np.zeros(5)), np.array([0.0, 1.0, 0.0, 0.0, 0.0]))
    slower = dataclasses.replace(small.model, max_velocity=np.full(5, 0.4))
    with pytest.raises(TrajectoryError, match=r"upper_joint: speed.*would be 0.5000, the limit is 0.4000"):
        check_limits(slower, path)
    with pytest.raises(TrajectoryError, match=r"upper_joint: position.*would be 1.9000, the limit is 1.8000"):
        point_to_point(small.model, at_rest(np.zeros(5)), np.array([0.0, 1.9, 0.0, 0.0, 0.0]))


def test_a_start_out_of_limits_may_come_back(small: Any) -> None:
    start = at_rest(np.array([0.0, 1.82, 0.0, 0.0, 0.0]))
    path = point_to_point(small.model, start, np.zeros(5))
    assert path.extremes()[1][1] <= 1.82 + 1e-9


def test_swinging_past_a_limit_is_avoided_by_braking_first(small: Any) -> None:
    # Joint 0 runs at its limit of speed towards 2.5 rad and has 0.3 rad left; joint 1 has a long way, so that
    # a synchronised motion would take its time over turning round.
    start = JointReference(np.array([2.2, -1.7, 0.0, 0.0, 0.0]), np.array([0.5, 0.0, 0.0, 0.0, 0.0]), np.zeros(5))
    path = point_to_point(small.model, start, np.array([2.2, 1.7, 0.0, 0.0, 0.0]))
    _assert_within_limits(small.model, path)


def _points(arm: Any, seed: int, count: int) -> Any:
    generator = np.random.default_rng(seed)
    middle = np.array(arm.params.named_poses["unfold"])
    return middle, middle + generator.uniform(-0.3, 0.3, (count, arm.model.joint_count))


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_points_are_passed_at_their_times_when_the_limits_allow(small: Any, seed: int) -> None:
    start, points = _points(small, seed, 5)
    times = np.arange(1.0, 6.0) * 4.0
    path, stretched = through_points(small.model, at_rest(start), points, times)
    assert not stretched
    assert path.duration == pytest.approx(20.0, abs=1e-4)
    for t, point in zip(times, points, strict=True):
        np.testing.assert_allclose(path.sample(t)[0], point, atol=1e-5)
    _assert_within_limits(small.model, path)


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_times_that_are_too_short_are_stretched_or_refused(explorer: Any, seed: int) -> None:
    start, points = _points(explorer, seed, 4)
    times = np.array([0.1, 0.2, 0.3, 0.4])
    path, stretched = through_points(explorer.model, at_rest(start), points, times)
    assert stretched and path.duration > 0.4
    _assert_within_limits(explorer.model, path)
    np.testing.assert_allclose(path.sample(path.duration)[0], points[-1], atol=1e-9)
    with pytest.raises(TrajectoryError, match=r"the points need .* s within the limits .*given were 0.400 s"):
        through_points(explorer.model, at_rest(start), points, times, retime=False)


def test_points_without_times_are_passed_in_order_without_stopping_on_a_line(small: Any) -> None:
    line = np.outer(np.array([0.2, 0.5, 0.9]), np.array([1.0, 0.5, -0.5, 0.3, 0.2]))
    path, _ = through_points(small.model, at_rest(np.zeros(5)), line, None)
    _assert_within_limits(small.model, path)
    times, position, velocity, _ = _sampled(path)
    nearest = [int(np.argmin(np.max(np.abs(position - point), axis=1))) for point in line]
    assert nearest == sorted(nearest)
    for k, point in zip(nearest, line, strict=True):
        np.testing.assert_allclose(position[k], point, atol=2e-3)
    assert np.max(np.abs(velocity[nearest[0] : nearest[1]]), axis=1).min() > 0.3
    assert times[-1] == path.duration


def test_given_velocities_are_kept_at_the_points(small: Any) -> None:
    points = np.outer(np.array([0.3, 0.6]), np.ones(5))
    velocities = np.vstack([np.full(5, 0.15), np.zeros(5)])
    path, stretched = through_points(small.model, at_rest(np.zeros(5)), points, np.array([2.0, 4.5]), velocities)
    assert not stretched
    np.testing.assert_allclose(path.sample(2.0)[1], 0.15, atol=1e-5)
    with pytest.raises(TrajectoryError, match="last point"):
        through_points(small.model, at_rest(np.zeros(5)), points, None, np.full((2, 5), 0.1))
