"""Places where the ground lies lower: of many in one spot the deepest stands for all."""

import numpy as np

from sojourn_machine.params import FloatArray

TOUCH_N = 1.0
"""Of a pad that does not touch the force is zero."""
NEAR = 0.02
"""Of places in the same square of this side the deepest stands for all [m]: half a pixel."""


def touching(places: FloatArray, forces: FloatArray, sinkage: FloatArray) -> FloatArray:
    """x, y and sinkage of what touches the ground, (n, 3) [m].

    Args:
        places: (m, 3) in map [m]. forces: (m, 3) [N]. sinkage: (m,) [m].
    """
    touches = np.linalg.norm(forces, axis=1) > TOUCH_N
    return np.column_stack([places[touches, :2], sinkage[touches]])


def deepest_of_each(nodes: FloatArray) -> FloatArray:
    """Of nodes (n, 3), x, y and depth [m], the deepest of each small square; a rut is as deep as its deepest."""
    squares = np.floor(nodes[:, :2] / NEAR)
    order = np.lexsort((-nodes[:, 2], squares[:, 1], squares[:, 0]))
    _, first = np.unique(squares[order], axis=0, return_index=True)
    return nodes[order[first]]
