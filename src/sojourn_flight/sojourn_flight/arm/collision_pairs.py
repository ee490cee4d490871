"""Which shapes of a machine can come against each other when its arm moves.

Every shape of a moving link against every shape that does not move, and against those of links that are not its
neighbours: neighbours share a joint, and touch by design. Shapes of the link that carries the first joint are
neighbours of the first moving link.
"""

from collections.abc import Collection
from typing import Any

import pinocchio


def add_collision_pairs(model: Any, shapes: Any, ignored: Collection[frozenset[str]] = ()) -> None:
    """Add the pairs to a Pinocchio geometry model.

    Args:
        model: Pinocchio model of one chain. shapes: its geometry model. ignored: pairs of link names to leave out.
    """
    mount = link_name(model, model.frames[model.getFrameId(model.names[1])].parentFrame)
    objects = list(shapes.geometryObjects)
    for i, moving in enumerate(objects):
        if moving.parentJoint == 0:
            continue
        for j, other in enumerate(objects):
            link, other_link = (link_name(model, shape.parentFrame) for shape in (moving, other))
            if other.parentJoint > 0 and (j < i or abs(int(moving.parentJoint) - int(other.parentJoint)) <= 1):
                continue
            if other.parentJoint == 0 and moving.parentJoint == 1 and other_link == mount:
                continue
            if frozenset((link, other_link)) not in ignored:
                shapes.addCollisionPair(pinocchio.CollisionPair(i, j))


def link_name(model: Any, frame: int) -> str:
    """Name of the link of a frame."""
    return str(model.frames[frame].name)


def rebase_shapes(model: Any, shapes: Any, base_link: str) -> None:
    """Place the shapes that no joint moves in the frame of a link; to be called before the model is re-based."""
    universe_to_base = model.frames[model.getFrameId(base_link)].placement.inverse()
    for shape in shapes.geometryObjects:
        if shape.parentJoint == 0:
            shape.placement = universe_to_base * shape.placement
