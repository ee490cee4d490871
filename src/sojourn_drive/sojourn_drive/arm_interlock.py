"""The drive waits for the arm: no goal and no velocity command while it is out, and a stop when it leaves its driving
pose on the way. The arm is where its joints are measured to be; the arm's node is not asked.
"""

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.values import JointState
from sojourn_flight.arm.interlock import why_not_to_drive
from sojourn_flight.arm.params import ArmParams


class ArmInterlock:
    """Watches the arm.

    Args:
        arm: None for a rover without one, which may always drive.
    """

    def __init__(self, arm: ArmParams | None) -> None:
        self._arm = arm
        self._places = JointPlaces("/joint_states", () if arm is None else arm.joint_names)

    def why_not(self, joints: JointState | None, driving: bool, before: str) -> str:
        """Why the rover may not drive by the measured joints of a period, in words; empty where it may. Where they
        cannot be used, or lack the arm's, the last word stays.
        """
        arm = self._arm
        if arm is None or joints is None:
            return before
        try:
            places = self._places.places(joints)
        except RefusedMessageError:
            return before
        positions, velocities = joints.position[places], joints.velocity[places]
        return why_not_to_drive(arm.interlock, arm.named_poses, arm.joint_names, positions, velocities, driving)
