"""Goes along sampled postures of an arm until a pair of its shapes may be near, compiled: see collision.py.

Shapes are held by spheres about their centres, which move with the joints: T_0i of chain.py.
"""

from typing import NamedTuple

import numpy as np

from sojourn_flight.arm.chain import Chain, joint_frames
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray


class ShapePairs(NamedTuple):
    """Pairs of shapes that must not meet."""

    shapes: IntArray
    """(pairs, 2)"""
    reach: FloatArray
    """(pairs, n): farthest that they move against each other when a joint moves by one [m/rad or m/m]."""
    clearance: FloatArray
    """(pairs,) [m]"""
    slack: FloatArray
    """(pairs,): way that they may still move without a look; used up, and set, here [m]."""


class ShapesOverGround(NamedTuple):
    """Shapes that must not meet the ground."""

    reach: FloatArray
    """(shapes, n), as that of pairs."""
    slack: FloatArray
    """(shapes,), as that of pairs."""


class BoundingSpheres(NamedTuple):
    """Spheres that hold the shapes."""

    radii: FloatArray
    """(shapes,) [m]"""
    parents: IntArray
    """(shapes,): joint that moves each, counted from 1; 0: none."""
    places: FloatArray
    """(shapes, 3): their centres in the frames of their joints [m]."""
    centres: FloatArray
    """(shapes, 3): in the base; those that move are written here [m]."""


@njit(cache=True)
def go_on(
    chain: Chain,
    samples: FloatArray,
    first: int,
    pairs: ShapePairs,
    over_ground: ShapesOverGround,
    spheres: BoundingSpheres,
    near: IntArray,
) -> tuple[int, int]:
    """The first sample from `first` on that needs a closer look, and how many pairs are in `near`; -1 for none.

    Args:
        samples: (m, n). near: numbers of pairs, written here.
    """
    n = samples.shape[1]
    slack, ground_slack, radii, centres = pairs.slack, over_ground.slack, spheres.radii, spheres.centres
    for k in range(first, samples.shape[0]):
        if k > 0:
            for j in range(n):
                turned = abs(samples[k, j] - samples[k - 1, j])
                if turned == 0.0:
                    continue
                for pair in range(slack.shape[0]):
                    slack[pair] -= pairs.reach[pair, j] * turned
                for shape in range(ground_slack.shape[0]):
                    ground_slack[shape] -= over_ground.reach[shape, j] * turned
        ground_due = False
        for shape in range(ground_slack.shape[0]):
            ground_due = ground_due or ground_slack[shape] <= 0.0
        count, moved = 0, False
        for pair in range(slack.shape[0]):
            if slack[pair] > 0.0:
                continue
            if not moved:
                _move_centres(chain, samples[k], spheres)
                moved = True
            one, two = pairs.shapes[pair, 0], pairs.shapes[pair, 1]
            apart = 0.0
            for m in range(3):
                apart += (centres[one, m] - centres[two, m]) ** 2
            slack[pair] = np.sqrt(apart) - radii[one] - radii[two] - pairs.clearance[pair]
            if slack[pair] <= 0.0:
                near[count] = pair
                count += 1
        if count > 0 or ground_due:
            return k, count
    return -1, 0


@njit(cache=True)
def _move_centres(chain: Chain, q: FloatArray, spheres: BoundingSpheres) -> None:
    parents, places, centres = spheres.parents, spheres.places, spheres.centres
    n = q.shape[0]
    rotations, positions = np.empty((n, 3, 3)), np.empty((n, 3))
    joint_frames(chain, q, rotations, positions)
    for shape in range(parents.shape[0]):
        if parents[shape] > 0:
            turn, at, place = rotations[parents[shape] - 1], positions[parents[shape] - 1], places[shape]
            for k in range(3):
                centres[shape, k] = at[k] + turn[k, 0] * place[0] + turn[k, 1] * place[1] + turn[k, 2] * place[2]
