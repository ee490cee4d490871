"""Rows of the topic table that operators publish: goals for drive and arm, requests to the power manager."""

from dataclasses import replace

from sojourn_contract.field_rules import ANGLE, GOAL, GOAL_FRAMES, PLACE, TEXTS
from sojourn_contract.topic_types import FieldRule, Topic

FAULTS_TOPIC = "/faults"
REFUSAL_TOLD_NS = 2_000_000_000
"""So long drive and arm tell that a goal was refused before they tell again of the one that goes on [ns]: two
statuses."""
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
        "/drive/question",
        "nav_msgs/Path",
        "operator",
        ("drive",),
        0,
        10.0,
        "what would it take to drive along these? Nothing moves; the answer is in /drive/status, its fields begin with "
        "asked_",
        (FieldRule("poses.pose.position", "m", frame="map, odom or base_link", low=-1e4, high=1e4),),
        frames=GOAL_FRAMES,
    ),
    Topic(
        "/initialpose",
        "geometry_msgs/PoseWithCovarianceStamped",
        "operator",
        ("drive",),
        0,
        10.0,
        "where base_link is, and where it heads, with the covariance of x, y and heading; the drive takes it while it "
        "stands, and answers in /drive/status, in fields that begin with placed_",
        PLACE,
        frames=("map", "odom"),
        needs_listener=False,
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
    Topic(
        "/mast/joint_goal",
        "sensor_msgs/JointState",
        "operator",
        ("plant",),
        0,
        10.0,
        "turn these joints, of those that neither drive nor arm moves, as a mast's pan and tilt, to these positions; "
        "the controllers of their motors take them there at the joints' own pace",
        (ANGLE,),
        joints="pointed",
        needs_listener=False,
    ),
    Topic("/arm/stop", "std_msgs/Header", "operator", ("arm",), 0, 10.0, "stop the arm and hold"),
    Topic(
        "/power/request",
        "diagnostic_msgs/DiagnosticArray",
        "operator",
        ("power",),
        0,
        10.0,
        "switch loads: the keys of its one status are loads, or sleep for the whole machine; their values on or off",
        (TEXTS,),
    ),
    Topic(
        FAULTS_TOPIC,
        "diagnostic_msgs/DiagnosticArray",
        "operator",
        ("plant", "sensors"),
        0,
        10.0,
        "a fault comes or goes: status[0].name is its name, state of its values present or gone, kind what it is, the "
        "others the words of its kind",
        (TEXTS,),
        needs_listener=False,
    ),
)
