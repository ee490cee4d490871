"""Goals as messages, as any operator sends them, and statuses as reports."""

import array
from math import cos, sin
from typing import Any

from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from sojourn_contract import stamps
from sojourn_contract.heartbeat import is_count, status_message, status_values
from sojourn_contract.messages import set_quaternion
from sojourn_operator.actions import Action, ArmAlong, ArmJoints, ArmTask, ArmTo, DriveAlong, DriveTo
from sojourn_operator.script import Report


def goal_message(action: Action, stamp: int) -> Any:
    """Message that asks for an action, stamped `stamp` [ns]. Raises TypeError for one that is no goal (a wait), or
    whose place is still to be looked up."""
    match action:
        case DriveTo():
            return _pose(action.frame, stamp, action.x, action.y, action.z, action.yaw)
        case DriveAlong():
            path = Path()
            path.header = _header(action.frame, stamp)
            last = len(action.points) - 1
            path.poses = [
                _pose(action.frame, stamp, x, y, 0.0, action.yaw if place == last else None)
                for place, (x, y) in enumerate(action.points)
            ]
            return path
        case ArmTo():
            pose = _pose(action.frame, stamp, action.x, action.y, action.z, None)
            set_quaternion(pose.pose.orientation, action.orientation)
            return pose
        case ArmJoints():
            joints = JointState()
            joints.header = _header(action.name, stamp)
            joints.name = [name for name, _ in action.positions]
            joints.position = array.array("d", [position for _, position in action.positions])
            return joints
        case ArmAlong():
            path = Path()
            path.header = _header(action.frame, stamp)
            for point in action.points:
                pose = _pose("arc" if point.on_arc else action.frame, stamp, point.x, point.y, point.z, None)
                set_quaternion(pose.pose.orientation, point.orientation)
                path.poses.append(pose)
            return path
        case ArmTask():
            return status_message(stamp, action.name, dict(action.values))
    raise TypeError(f"{action!r} is no goal")


def stop_messages(stamp: int) -> list[tuple[str, Any]]:
    """Messages that stop everything: a velocity of zero for the drive, a stop for the arm, as (topic, message)."""
    twist = TwistStamped()
    twist.header = _header("base_link", stamp)
    return [("/cmd_vel", twist), ("/arm/stop", _header("", stamp))]


def report_of(status: Any) -> Report:
    """What a status message says of its goal."""
    values = status_values(status)
    stamp = values.get("goal_stamp", "0")
    return Report(values.get("state", ""), int(stamp) if is_count(stamp) else 0, values.get("reason", ""))


def _header(frame: str, stamp: int) -> Header:
    return Header(stamp=stamps.to_message(stamp), frame_id=frame)


def _pose(frame: str, stamp: int, x: float, y: float, z: float, yaw: float | None) -> PoseStamped:
    """A pose; an orientation of zero length means any."""
    pose = PoseStamped()
    pose.header = _header(frame, stamp)
    position, orientation = pose.pose.position, pose.pose.orientation
    position.x, position.y, position.z = float(x), float(y), float(z)
    orientation.w = 0.0 if yaw is None else cos(yaw / 2.0)
    orientation.z = 0.0 if yaw is None else sin(yaw / 2.0)
    return pose
