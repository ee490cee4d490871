"""Where the links of a machine are in one another: what RViz and others ask of a robot beside its URDF.

A link stands in the link above it as its joint's origin does, turned about the joint's axis by its angle, or moved
along it (URDF specification). A joint that is not told stands at zero. The frame of a camera's images stands on its
link, with z ahead, x right and y down (REP 103).
"""

import math
from collections.abc import Iterable, Mapping

from sojourn_bags.transforms import Transform, TransformTemplate
from sojourn_config.urdf import MOVING, UrdfJoint, UrdfSummary
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of

OPTICAL = Transform((0.0, 0.0, 0.0), (-0.5, 0.5, -0.5, 0.5))
"""Of the frame of an image in the link of its camera."""


class LinkFrames:
    """Of one machine.

    Args:
        optical: link and frame of each camera's images.
    """

    def __init__(self, urdf: UrdfSummary, optical: Iterable[tuple[str, str]] = ()) -> None:
        joints = urdf.joints.values()
        self._moving = [(joint, origin_of(joint)) for joint in joints if joint.kind in MOVING]
        fixed = [joint for joint in joints if joint.kind not in MOVING]
        images = tuple(dict.fromkeys(optical))  # several cameras may sit on one link
        self._at_rest = (*(origin_of(joint) for joint in fixed), *(OPTICAL for _ in images))
        self._fixed_links = TransformTemplate((*((joint.parent, joint.child) for joint in fixed), *images))
        self._moving_links = TransformTemplate(tuple((joint.parent, joint.child) for joint, _ in self._moving))

    def fixed(self) -> bytes:
        """TFMessage in CDR of those that never move, stamped zero."""
        return self._fixed_links.fill(0, self._at_rest)

    def moving(self, stamp: int, positions: Mapping[str, float]) -> bytes:
        """TFMessage in CDR of all others at a stamp [ns]; positions by joint [rad, m]."""
        places = (moved(joint, origin, positions.get(joint.name, 0.0)) for joint, origin in self._moving)
        return self._moving_links.fill(stamp, tuple(places))


def origin_of(joint: UrdfJoint) -> Transform:
    """Of the child in the parent with the joint at zero."""
    matrix = joint.transform_parent_to_joint
    return Transform(_vector(matrix[:3, 3]), tuple(quaternion_of(matrix[:3, :3]).tolist()))


def moved(joint: UrdfJoint, origin: Transform, position: float) -> Transform:
    """The same with the joint at a position [rad, m]."""
    x, y, z = _vector(joint.axis)
    if joint.kind == "prismatic":
        return origin @ Transform((position * x, position * y, position * z), (0.0, 0.0, 0.0, 1.0))
    sine = math.sin(0.5 * position)
    return origin @ Transform((0.0, 0.0, 0.0), (sine * x, sine * y, sine * z, math.cos(0.5 * position)))


def _vector(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
