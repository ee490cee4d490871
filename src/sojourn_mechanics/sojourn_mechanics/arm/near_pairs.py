"""Goes along sampled postures of an arm until a pair of its shapes may be near, compiled: see collision.py.

Shapes are held by spheres about their centres, which move with the joints: T_0i of chain.py.
"""

import numpy as np
from numba import njit

from sojourn_mechanics.arm.chain import Chain
from sojourn_mechanics.params import FloatArray, IntArray


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
    rotation, position = np.eye(3), np.zeros(3)
    turn = np.empty((3, 3))
    for i in range(q.shape[0]):
        position = position + _apply(rotation, chain.translation[i])
        rotation = _product(rotation, chain.rotation[i])
        x, y, z = chain.axis[i, 0], chain.axis[i, 1], chain.axis[i, 2]
        if chain.revolute[i] > 0.5:
            s, c = np.sin(q[i]), np.cos(q[i])
            v = 1.0 - c
            turn[0, 0], turn[0, 1], turn[0, 2] = c + x * x * v, x * y * v - z * s, x * z * v + y * s
            turn[1, 0], turn[1, 1], turn[1, 2] = x * y * v + z * s, c + y * y * v, y * z * v - x * s
            turn[2, 0], turn[2, 1], turn[2, 2] = x * z * v - y * s, y * z * v + x * s, c + z * z * v
            rotation = _product(rotation, turn)
        else:
            position = position + _apply(rotation, chain.axis[i]) * q[i]
        for shape in range(parents.shape[0]):
            if parents[shape] == i + 1:
                centres[shape] = position + _apply(rotation, places[shape])


@njit(cache=True)
def _apply(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    out = np.empty(3)
    for i in range(3):
        out[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]
    return out


@njit(cache=True)
def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    out = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
    return out
