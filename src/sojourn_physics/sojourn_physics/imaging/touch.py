"""Plates that touch: how far the ground is before a plate, and whether a switch behind it is closed.

A plate of width b and height h that can be pushed back by its travel t closes a contact when it meets something. Seen
from where it would be without meeting anything, that is ground, or a stone on it, within t before some place of its
face. The face is looked over at nodes at most half a node of the ground apart, and from each of them ahead in such
steps, with a straight line between two; what is smaller is missed. The point at which the contact closes is off by an
error of its own at each reading (repeatability: the word of data sheets of snap-action switches, MIL-PRF-8805).
"""

import math

import numpy as np
from pydantic import Field

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.imaging.ground import DrawnGround, height_at

PART_OF_NODE = 0.5
"""Distance of two places that are looked at, of the distance of the ground's nodes [-]."""


class BumpSwitchParams(Params):
    """A plate across x of its link, its middle at the link's origin, and the switch behind it."""

    width: float = Field(gt=0.0, le=10.0, description="of the plate, along y [m]")
    height: float = Field(gt=0.0, le=10.0, description="of the plate, along z [m]")
    travel: float = Field(gt=0.0, le=1.0, description="how far ahead of it something closes the contact [m]")
    repeatability: float = Field(
        default=0.0, ge=0.0, le=0.1, description="standard deviation of where the contact closes [m]"
    )


def face_of(params: BumpSwitchParams, node: float) -> FloatArray:
    """Places of the plate in the frame of its link, (n, 3) [m]; node: distance of the ground's nodes [m]."""
    sides = [
        np.linspace(-0.5 * side, 0.5 * side, math.ceil(side / (PART_OF_NODE * node)) + 1)
        for side in (params.width, params.height)
    ]
    y, z = np.meshgrid(*sides, indexing="ij")
    return np.column_stack([np.zeros(y.size), y.ravel(), z.ravel()])


@njit(cache=True)
def way_ahead(ground: DrawnGround, places: FloatArray, ahead: FloatArray, farthest: float) -> float:
    """Shortest way to the ground along one direction from some places [m], infinite for none within `farthest`.

    Args:
        places: in map, (n, 3) [m]. ahead: unit vector in map, (3,). farthest: [m].
    """
    nearest = math.inf
    step = PART_OF_NODE * ground.place[3]
    for i in range(places.shape[0]):
        x, y, z = places[i, 0], places[i, 1], places[i, 2]
        way, over = 0.0, z - height_at(ground, x, y)
        if over <= 0.0:
            return 0.0
        while way < min(nearest, farthest):
            further = min(way + step, farthest)
            beyond = z + further * ahead[2] - height_at(ground, x + further * ahead[0], y + further * ahead[1])
            if beyond <= 0.0:
                nearest = min(nearest, way + (further - way) * over / (over - beyond))
                break
            way, over = further, beyond
    return nearest


def is_closed(params: BumpSwitchParams, way: float, random: np.random.Generator) -> bool:
    """Whether the contact is closed, where the ground is so far ahead [m]."""
    return bool(way <= params.travel + params.repeatability * float(random.standard_normal()))
