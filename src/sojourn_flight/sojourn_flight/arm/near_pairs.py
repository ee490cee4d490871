"""Goes along sampled postures of an arm until a pair of its shapes may be near, compiled: see collision.py.

Shapes are held by spheres about their centres, which move with the joints: T_0i of chain.py.
"""

import numpy as np

from sojourn_flight.arm.chain import Chain, joint_frames
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray


@njit(cache=True)
def go_on(
    chain: Chain,
    samples: FloatArray,
    first: int,
    slack: FloatArray,
    ground_slack: FloatArray,
    pair_reach: FloatArray,
    shape_reach: FloatArray,
    pair_shapes: IntArray,
    radii: FloatArray,
    clearance: FloatArray,
    parents: IntArray,
    places: FloatArray,
    centres: FloatArray,
    near: IntArray,
) -> tuple[int, int]:
    """The first sample from `first` on that needs a closer look, and how many pairs are in `near`; -1 for none.

    Args:
        slack, ground_slack: ways that pairs and shapes may still move without a look; used up, and set, here.
        parents, places: joint (0: none) that moves each shape, and its centre in that joint's frame [m].
        centres: (shapes, 3) in the base; those that move are written here.
        near: written here.
    """
    n = samples.shape[1]
    for k in range(first, samples.shape[0]):
        if k > 0:
            for j in range(n):
                turned = abs(samples[k, j] - samples[k - 1, j])
                if turned == 0.0:
                    continue
                for pair in range(slack.shape[0]):
                    slack[pair] -= pair_reach[pair, j] * turned
                for shape in range(ground_slack.shape[0]):
                    ground_slack[shape] -= shape_reach[shape, j] * turned
        ground_due = False
        for shape in range(ground_slack.shape[0]):
            ground_due = ground_due or ground_slack[shape] <= 0.0
        count, moved = 0, False
        for pair in range(slack.shape[0]):
            if slack[pair] > 0.0:
                continue
            if not moved:
                _move_centres(chain, samples[k], parents, places, centres)
                moved = True
            one, two = pair_shapes[pair, 0], pair_shapes[pair, 1]
            apart = 0.0
            for m in range(3):
                apart += (centres[one, m] - centres[two, m]) ** 2
            slack[pair] = np.sqrt(apart) - radii[one] - radii[two] - clearance[pair]
            if slack[pair] <= 0.0:
                near[count] = pair
                count += 1
        if count > 0 or ground_due:
            return k, count
    return -1, 0


@njit(cache=True)
def _move_centres(chain: Chain, q: FloatArray, parents: IntArray, places: FloatArray, centres: FloatArray) -> None:
    n = q.shape[0]
    rotations, positions = np.empty((n, 3, 3)), np.empty((n, 3))
    joint_frames(chain, q, rotations, positions)
    for shape in range(parents.shape[0]):
        if parents[shape] > 0:
            turn, at, place = rotations[parents[shape] - 1], positions[parents[shape] - 1], places[shape]
            for k in range(3):
                centres[shape, k] = at[k] + turn[k, 0] * place[0] + turn[k, 1] * place[1] + turn[k, 2] * place[2]
