"""nav2_msgs/NavigateToPose: /goal_pose with /drive/status."""

from typing import Any

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import topic
from sojourn_contract.values import Message, PoseStamped
from sojourn_operator.actions.conversion import duration, ros_message, value_of
from sojourn_operator.actions.kind import LastHeard, action_type
from sojourn_operator.actions.watch import ABORTED, Ending
from sojourn_operator.goal_sending import STANDING_M_S

ODOM = topic("/odom")
GOAL = topic("/goal_pose")
UNKNOWN = 9000
"""`error_code` of what went wrong for a reason that the action has no number for: that of Nav2."""


class NavigateToPose:
    """Drives to a pose."""

    name = "NavigateToPose"
    package = "nav2_msgs"
    role = "drive"
    topic = GOAL.name
    hears: tuple[str, ...] = (ODOM.name,)

    def begin(self, request: Any) -> "DrivePursuit":
        """See ActionKind."""
        if request.behavior_tree:
            raise RefusedMessageError(
                self.name, "behavior_tree", repr(request.behavior_tree), "none: the drive has its own ways"
            )
        return DrivePursuit(action_type(self), value_of(GOAL, request.pose))


class DrivePursuit:
    """See Pursuit."""

    def __init__(self, action: Any, goal: Message) -> None:
        self._action, self.goal = action, goal._replace(stamp=0)

    def feedback(self, heard: LastHeard) -> Any:
        """See Pursuit. The time that remains is that of what is to go at the present speed, as Nav2 tells it."""
        said = self._action.Feedback()
        here = heard.messages.get(ODOM.name)
        if here is not None:
            pose = PoseStamped(here.stamp, here.frame, here.position, here.orientation)
            said.current_pose = ros_message(GOAL, pose)
        # Of a rover that stands no time of arrival can be told.
        way, speed = (float(heard.status.get(name, 0.0)) for name in ("distance_to_go", "speed_m_s"))
        duration(said.navigation_time, heard.now - heard.begun)
        duration(said.estimated_time_remaining, round(way / speed * NANOSECONDS) if speed > STANDING_M_S else 0)
        said.number_of_recoveries = int(float(heard.status.get("detours", 0.0)))
        said.distance_remaining = way
        return said

    def breach(self, heard: LastHeard) -> str:
        """See Pursuit: the drive watches over itself."""
        return ""

    def final(self, ending: Ending, heard: LastHeard) -> Ending:
        """See Pursuit."""
        return ending

    def result(self, ending: Ending) -> Any:
        """See Pursuit. Jazzy's result has a number alone, later ones words besides."""
        result = self._action.Result()
        if ending.word == ABORTED:
            result.error_code = getattr(type(result), "UNKNOWN", UNKNOWN)
        if hasattr(result, "error_msg"):
            result.error_msg = ending.reason
        return result
