"""The drive waits for the arm: no goal and no velocity command while it is out, and a stop when it leaves its driving
pose on the way. The arm is where its joints are measured to be; the arm's node is not asked.
"""

from typing import Any

import numpy as np

from sojourn_mechanics.arm.interlock import why_not_to_drive
from sojourn_mechanics.arm.params import ArmParams


class ArmInterlock:
    """Watches the arm.

    Args:
        arm: None for a rover without one, which may always drive.
    """

    def __init__(self, arm: ArmParams | None) -> None:
        self._arm = arm
        self._places: tuple[list[str], list[int]] = ([], [])
        self.reason = ""
        """Why the rover may not drive, in words; empty where it may."""

    def hear(self, joints: Any, driving: bool) -> None:
        """Take the measured joints of a period; where they cannot be used, or lack the arm's, the last word stays."""
        arm = self._arm
        if arm is None or joints is None:
            return
        if self._places[0] != joints.name:
            names = list(joints.name)
            if not set(arm.joint_names) <= set(names):
                return
            self._places = (names, [names.index(name) for name in arm.joint_names])
        places = self._places[1]
        positions, velocities = np.array(joints.position)[places], np.array(joints.velocity)[places]
        self.reason = why_not_to_drive(arm.interlock, arm.named_poses, arm.joint_names, positions, velocities, driving)
