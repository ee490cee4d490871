"""A machine that stands still in a posture, from its URDF alone: where its links are, its weight, what its joints hold.

    T = prod T_parent_to_joint T_q        along the tree, at the given joint positions
    tau_i = -s_i . (sum m g x arm)        of all that hangs on joint i; F_i = -a_i . (sum m g) of one that slides

with g straight down in the root link. Numpy only: a configuration is checked before any physics library is loaded.
"""

from collections.abc import Mapping

import numpy as np

from sojourn_config.urdf import UrdfJoint, UrdfSummary
from sojourn_machine.params import FloatArray


class StillMachine:
    """Links in the root's frame at joint positions by name [rad or m]; joints that are not named are at zero."""

    def __init__(self, urdf: UrdfSummary, positions: Mapping[str, float]) -> None:
        self._urdf = urdf
        self._places: dict[str, FloatArray] = {urdf.root: np.eye(4)}
        below: dict[str, list[UrdfJoint]] = {}
        for joint in urdf.joints.values():
            below.setdefault(joint.parent, []).append(joint)
        frontier = [urdf.root]
        while frontier:
            here = frontier.pop()
            for joint in below.get(here, ()):
                moved = joint.transform_parent_to_joint @ _motion(joint, positions.get(joint.name, 0.0))
                self._places[joint.child] = self._places[here] @ moved
                frontier.append(joint.child)

    def place(self, link: str) -> FloatArray:
        """Homogeneous transform of a link in the root, (4, 4)."""
        return self._places[link]

    def weight_of(self, links: tuple[str, ...]) -> tuple[float, FloatArray]:
        """Mass of these links [kg] and its centre in the root, (3,) [m]."""
        mass, moment = 0.0, np.zeros(3)
        for link in links:
            inertial = self._urdf.inertials.get(link)
            if inertial is not None:
                mass += inertial.mass
                moment += inertial.mass * (self._places[link] @ np.append(inertial.centre, 1.0))[:3]
        return mass, moment / mass if mass > 0.0 else np.zeros(3)

    def held_by(self, name: str, gravity: float) -> float:
        """Effort with which a joint holds what hangs on it, the root level in a gravity [m/s2]: [N m or N]."""
        joint = self._urdf.joints[name]
        mass, centre = self.weight_of(self._urdf.below(joint.child))
        place, weight = self._places[joint.child], np.array([0.0, 0.0, -mass * gravity])
        axis = place[:3, :3] @ joint.axis
        pull = weight if joint.kind == "prismatic" else np.cross(centre - place[:3, 3], weight)
        return float(-axis @ pull)


def _motion(joint: UrdfJoint, position: float) -> FloatArray:
    """Transform of a joint's own motion, (4, 4)."""
    moved = np.eye(4)
    if joint.kind == "prismatic":
        moved[:3, 3] = position * joint.axis
    elif joint.kind != "fixed":
        x, y, z = joint.axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        moved[:3, :3] += np.sin(position) * cross + (1.0 - np.cos(position)) * (cross @ cross)
    return moved
