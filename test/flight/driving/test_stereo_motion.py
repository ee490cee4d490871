"""Motion by points that both looks have seen: exact, with errors as they are told, among points that do not move."""

import math

import numpy as np
import pinocchio as pin
import pytest

from sojourn_flight.odometry.stereo_geometry import (
    CameraPlace,
    Motion,
    PinholePair,
    projected,
    seen_after,
    triangulated,
)
from sojourn_flight.odometry.stereo_motion import FoundMotion, Looks, found_motion
from sojourn_machine.params import FloatArray

PAIR = PinholePair(300.0, (127.5, 95.5), 0.2)
DOWN = np.array([[0.0, -0.34, 0.94], [-1.0, 0.0, 0.0], [0.0, -0.94, -0.34]])
CAMERA = CameraPlace(np.linalg.svd(DOWN)[0] @ np.linalg.svd(DOWN)[2], np.array([0.4, 0.1, 1.0]))
TRUE = Motion(pin.exp3(np.array([0.01, -0.02, 0.05])), np.array([0.2, 0.02, -0.01]))
STILL = Motion(np.eye(3), np.zeros(3))


def looks(seed: int, noise: float = 0.0, count: int = 80, moved: Motion = TRUE) -> Looks:
    """Ground 1.5 m below and 2 to 8 m ahead, seen before and after."""
    random = np.random.default_rng(seed)
    points = np.column_stack(
        [random.uniform(-0.4, 0.4, count), random.uniform(-0.2, 0.3, count), np.ones(count)]
    ) * random.uniform(2.0, 8.0, (count, 1))
    first, second = projected(PAIR, points), projected(PAIR, seen_after(CAMERA, moved, points))
    return Looks(CAMERA, PAIR, *(seen + noise * random.standard_normal(seen.shape) for seen in (first, second)))


def find(seen: Looks, guess: Motion = STILL, outlier: float = 1.5) -> FoundMotion | None:
    return found_motion(seen, guess, np.random.default_rng(1), outlier, 0.01)


def error(found: FoundMotion, true: Motion = TRUE) -> FloatArray:
    """Of shift and turn, shape (6,)."""
    return np.concatenate([found.motion.shift - true.shift, pin.log3(found.motion.turn @ true.turn.T)])


@pytest.mark.parametrize("seed", range(5))
def test_without_errors_the_motion_is_exact(seed: int) -> None:
    found = find(looks(seed))
    assert found is not None and found.agree.all() and found.deviation == 0.01
    np.testing.assert_allclose(error(found), 0.0, atol=1e-8)


def test_the_covariance_is_that_of_the_errors() -> None:
    """120 draws of the noise: the sum of squared errors over their covariance is as a chi-square of 6 times as many."""
    draws, noise = 120, 0.15
    squares, deviations = 0.0, []
    for seed in range(draws):
        found = find(looks(seed, noise))
        assert found is not None
        off = error(found)
        squares += float(off @ np.linalg.solve(found.covariance, off))
        deviations.append(found.deviation)
    assert abs(squares - 6 * draws) < 4.0 * math.sqrt(2 * 6 * draws)
    assert np.mean(deviations) == pytest.approx(noise, rel=0.03)


@pytest.mark.parametrize("part", [0.2, 0.45])
def test_points_that_do_not_move_with_the_ground_are_left_out(part: float) -> None:
    """Parts of the machine and its shadow: seen where they were."""
    seen = looks(3, 0.1)
    with_machine = round(part * len(seen.first))
    seen.second[:with_machine] = seen.first[:with_machine]
    found = find(seen)
    assert found is not None
    assert found.agree[with_machine:].mean() > 0.95 and not found.agree[:with_machine].any()
    off = error(found)
    assert off @ np.linalg.solve(found.covariance, off) < 22.5  # one in a thousand


def test_the_same_points_and_numbers_give_the_same_motion() -> None:
    one, other = find(looks(4, 0.2)), find(looks(4, 0.2))
    assert one is not None and other is not None
    assert np.array_equal(one.covariance, other.covariance) and np.array_equal(one.motion.shift, other.motion.shift)


def test_a_guess_that_is_off_leads_there_as_well() -> None:
    seen = looks(5, 0.1)
    near, far = find(seen, TRUE), find(seen, Motion(pin.exp3(np.array([0.0, 0.03, -0.1])), np.array([-0.1, 0.1, 0.0])))
    assert near is not None and far is not None
    np.testing.assert_allclose(near.motion.shift, far.motion.shift, atol=1e-6)


def test_too_few_points_and_points_that_agree_on_nothing_make_no_motion() -> None:
    assert find(looks(6, count=5)) is None
    random = np.random.default_rng(7)
    seen = looks(7)
    nonsense = Looks(CAMERA, PAIR, seen.first, random.uniform(0.0, 250.0, seen.second.shape))
    found = find(nonsense, outlier=0.5)
    assert found is None or found.agree.sum() < 0.2 * len(seen.first)


def test_far_points_tell_the_turn_and_near_ones_the_way() -> None:
    """By the covariance: without what is near, the way is known worse by far, the turn about as well."""
    seen = looks(8, 0.1, 300)
    depth = triangulated(PAIR, seen.first)[:, 2]
    alike = [np.nonzero(part)[0][:60] for part in (depth < 3.5, depth > 6.5)]
    near, far = (find(Looks(CAMERA, PAIR, seen.first[part], seen.second[part])) for part in alike)
    assert near is not None and far is not None
    (way, turn), (far_way, far_turn) = (
        (math.sqrt(one.covariance[0, 0]), math.sqrt(one.covariance[5, 5])) for one in (near, far)
    )
    assert far_way > 3.0 * way and far_turn < 2.0 * turn
