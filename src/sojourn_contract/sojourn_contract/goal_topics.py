"""Rows of the topic table that operators publish: goals for drive and arm."""

from dataclasses import replace

from sojourn_contract.field_rules import ANGLE, GOAL, GOAL_FRAMES, TEXTS
from sojourn_contract.topic_types import FieldRule, Topic

GOAL_TOPICS: tuple[Topic, ...] = (
    Topic(
        "/cmd_vel",
        "geometry_msgs/TwistStamped",
        "operator",
        ("drive",),
        0,
        0.5,
        "wanted velocity of base_link",
        (
            FieldRule("twist.linear", "m/s", frame="base_link", low=-10.0, high=10.0),
            FieldRule("twist.angular", "rad/s", frame="base_link", low=-10.0, high=10.0),
        ),
        frames=("base_link", ""),
    ),
    Topic(
        "/goal_pose",
        "geometry_msgs/PoseStamped",
        "operator",
        ("drive",),
        0,
        10.0,
        "drive there",
        GOAL,
        frames=GOAL_FRAMES,
    ),
    Topic(
        "/waypoints",
        "nav_msgs/Path",
        "operator",
        ("drive",),
        0,
        10.0,
        "drive along these",
        (FieldRule("poses.pose.position", "m", frame="map, odom or base_link", low=-1e4, high=1e4),),
        frames=GOAL_FRAMES,
    ),
    Topic(
        "/arm/goal_pose",
        "geometry_msgs/PoseStamped",
        "operator",
        ("arm",),
        0,
        10.0,
        "place the arm's tip there; an orientation other than identity or zero asks for the direction of its tool, and "
        "for the roll where config/arms says so",
        GOAL,
        frames=GOAL_FRAMES,
    ),
    Topic(
        "/arm/joint_goal",
        "sensor_msgs/JointState",
        "operator",
        ("arm",),
        0,
        10.0,
        "move to these joint positions; a header.frame_id of stow or unfold and no joints asks for that pose",
        (replace(ANGLE, optional=True),),
        joints="arm",
    ),
    Topic(
        "/arm/joint_trajectory",
        "trajectory_msgs/JointTrajectory",
        "operator",
        ("arm",),
        0,
        10.0,
        "move through these joint positions",
        (FieldRule("points.positions", "rad", low=-10.0, high=10.0),),
        joints="arm",
    ),
    Topic(
        "/arm/path",
        "nav_msgs/Path",
        "operator",
        ("arm",),
        0,
        10.0,
        "move the arm's tip from where it is along straight lines to these poses in turn; a pose whose own "
        "header.frame_id is arc is gone by on an arc, from the pose before to the one after; an orientation other than "
        "identity or zero asks for the direction of the tool there, as in /arm/goal_pose",
        (FieldRule("poses.pose.position", "m", frame="map, odom or base_link", low=-1e4, high=1e4),),
        frames=GOAL_FRAMES,
    ),
    Topic(
        "/arm/cmd_vel",
        "geometry_msgs/TwistStamped",
        "operator",
        ("arm",),
        0,
        0.5,
        "wanted velocity of the arm's tip, in base_link (or no frame), map, odom or the frame of the tip's link",
        (
            FieldRule("twist.linear", "m/s", frame="header.frame_id", low=-10.0, high=10.0),
            FieldRule("twist.angular", "rad/s", frame="header.frame_id", low=-10.0, high=10.0),
        ),
    ),
    Topic(
        "/arm/task",
        "diagnostic_msgs/DiagnosticArray",
        "operator",
        ("arm",),
        0,
        10.0,
        "carry out a task: status[0].name says which, its values are its numbers",
        (TEXTS,),
    ),
    Topic("/arm/stop", "std_msgs/Header", "operator", ("arm",), 0, 10.0, "stop the arm and hold"),
)
