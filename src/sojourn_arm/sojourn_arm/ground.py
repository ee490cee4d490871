"""What the arm's node takes for the ground: looked at when a goal comes, and kept until the next one."""

from collections.abc import Sequence
from typing import Any

from sojourn_mechanics.arm.collision import GroundPlane
from sojourn_mechanics.arm.ground import GroundUnderWheels
from sojourn_mechanics.arm.params import ArmParams


class Ground:
    """The plane that motions are checked against.

    Args:
        wheels: joint and radius [m] of each wheel of the machine.
    """

    def __init__(self, params: ArmParams, urdf_xml: str, wheels: Sequence[tuple[str, float]]) -> None:
        self.plane: GroundPlane | None = None
        self._under: GroundUnderWheels | None = None
        if params.avoid_ground and params.ground_height is not None:
            self.plane = GroundPlane(params.ground_height)
        elif params.avoid_ground and wheels:
            self._under = GroundUnderWheels(urdf_xml, wheels, params.base_link)

    def look(self, joints: Any) -> None:
        """Find the plane anew, with the suspension as /joint_states tells it."""
        if self._under is not None and joints is not None:
            self.plane = self._under.plane(dict(zip(joints.name, joints.position, strict=True)))
