"""The topic table: the interface of Sojourn as data. Every node, the recorder, the checks and the manual
read it.

A row says who publishes, who subscribes, at which rate, how old a message may be, and for each field its
unit, its frame and its plausible range. Rows stand in the order in which data flows through one control
period, from the plant's truth to the commands that go back to it.
"""

from collections.abc import Collection
from dataclasses import replace

from sojourn_contract.errors import UnknownRoleError, UnknownTopicError
from sojourn_contract.field_rules import (
    ANGLE,
    BATTERY,
    COVARIANCE,
    EFFORT,
    ENCODER_RATE,
    ESTIMATED_TWIST,
    FLOAT32_TOLERANCE,
    FORCE_TOLERANCE,
    MEASURED_RATE,
    POSE,
    RATE,
    TEXTS,
    TORQUE_TOLERANCE,
    TRUE_TWIST,
    WRENCH,
)
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.topic_types import INFINITY, FieldRule, Topic

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
"""Every role, in the order in which a period passes through them."""

OPERATOR_LAG = 5
"""Periods between the operator's look at the machine and the effect of its goals, in lock-step."""
RECORDER_LAG = 25
"""Periods that the recorder may lag behind the plant, in lock-step."""

TOPICS: tuple[Topic, ...] = (
    Topic("/clock", "rosgraph_msgs/Clock", "plant", (), 1, 0.1, "simulation time", (FieldRule("clock", "s"),)),
    Topic(
        "/truth/odom",
        "nav_msgs/Odometry",
        "plant",
        ("sensors", "operator"),
        1,
        0.1,
        "true pose of base_link in map, true twist in base_link; on the diagonal of the twist's covariance the mean "
        "square of what the twist was within the period less what it is at its end",
        POSE + TRUE_TWIST,
        frames=("map",),
        child_frame="base_link",
    ),
    Topic(
        "/truth/contacts",
        "sensor_msgs/PointCloud2",
        "plant",
        (),
        1,
        0.1,
        "one point a wheel or pad: x y z, sinkage, slip_ratio, slip_angle, force_x force_y force_z, torque, soil, "
        "deflection, rolling_resistance, compaction_resistance, bulldozing_resistance, power",
        (
            FieldRule("x y z", "m", frame="map", low=-1e5, high=1e5),
            FieldRule("sinkage", "m", low=-1.0, high=1.0),
            FieldRule("slip_ratio", "1", low=-1.0, high=1.0),
            FieldRule("slip_angle", "rad", low=-3.2, high=3.2),
            FieldRule("force_x force_y force_z", "N", frame="map", low=-1e6, high=1e6, tolerance=FORCE_TOLERANCE),
            FieldRule("torque", "N m", low=-1e5, high=1e5, tolerance=TORQUE_TOLERANCE),
            FieldRule("soil", "index", low=0.0, high=255.0),
            FieldRule("deflection", "m", low=0.0, high=5.0),
            FieldRule("rolling_resistance compaction_resistance bulldozing_resistance", "N", low=0.0, high=1e6),
            FieldRule("power", "W", low=-1e6, high=1e6),
        ),
        frames=("map",),
    ),
    Topic(
        "/truth/electrical",
        "sensor_msgs/BatteryState",
        "plant",
        ("sensors",),
        5,
        0.5,
        "true state of the battery",
        BATTERY,
    ),
    Topic(
        "/truth/loads",
        "diagnostic_msgs/DiagnosticArray",
        "plant",
        ("sensors",),
        5,
        0.5,
        "power that each load draws, and the energy account of the run",
        (FieldRule("status.values", "W, J"),),
    ),
    Topic(
        "/truth/wrist_wrench",
        "geometry_msgs/WrenchStamped",
        "plant",
        ("sensors",),
        1,
        0.1,
        "true load on the wrist's force sensor, mean of the period: weight, inertia and contact of the tool",
        WRENCH,
        part="arm",
    ),
    Topic(
        "/truth/joint_states",
        "sensor_msgs/JointState",
        "plant",
        ("sensors",),
        1,
        0.1,
        "true position, rate and effort of every joint",
        (ANGLE, MEASURED_RATE, EFFORT),
        joints="moving",
    ),
    Topic(
        "/truth/motor_states",
        "sensor_msgs/JointState",
        "plant",
        ("sensors",),
        1,
        0.1,
        "true angle and rate, over the gear, of motors whose gear has play, and the torque through its teeth",
        (ANGLE, MEASURED_RATE, EFFORT),
    ),
    Topic(
        "/bus/state",
        "sensor_msgs/BatteryState",
        "sensors",
        ("power",),
        5,
        0.5,
        "measured voltage, current and temperature of the bus",
        BATTERY,
    ),
    Topic(
        "/joint_states",
        "sensor_msgs/JointState",
        "sensors",
        ("drive", "arm"),
        1,
        0.1,
        "measured position and rate of every joint with an encoder",
        (ANGLE, ENCODER_RATE, replace(EFFORT, optional=True)),
        joints="measured",
    ),
    Topic(
        "/wrist/wrench",
        "geometry_msgs/WrenchStamped",
        "sensors",
        ("arm",),
        1,
        0.1,
        "measured force and moment of the tool on the arm; NaN where the arm has no such sensor",
        WRENCH,
        part="arm",
    ),
    Topic(
        "/imu/data",
        "sensor_msgs/Imu",
        "sensors",
        ("drive", "arm"),
        1,
        0.1,
        "measured angular velocity and specific force, estimated attitude; NaN while it has no power",
        (
            FieldRule("orientation", "", frame="map to imu_link", low=-1.0, high=1.0, optional=True),
            FieldRule(
                "angular_velocity",
                "rad/s",
                frame="imu_link",
                low=-20.0,
                high=20.0,
                rate_of="orientation",
                rate_tolerance=0.5,
                optional=True,
            ),
            FieldRule("linear_acceleration", "m/s^2", frame="imu_link", low=-500.0, high=500.0, optional=True),
        ),
        frames=("imu_link",),
    ),
    Topic(
        "/sun_direction",
        "geometry_msgs/Vector3Stamped",
        "sensors",
        ("drive",),
        50,
        3.0,
        "measured direction to the Sun in the frame of its sensor, a unit vector; zeros where no Sun is seen",
        (FieldRule("vector", "1", low=-1.0, high=1.0),),
    ),
    Topic(
        "/hazcam/points",
        "sensor_msgs/PointCloud2",
        "sensors",
        ("drive", "arm"),
        50,
        3.0,
        "measured points of the ground ahead: x y z; none from a machine whose hazard camera is off, or without one",
        (FieldRule("x y z", "m", frame="base_link", low=-100.0, high=100.0, tolerance=FLOAT32_TOLERANCE),),
        frames=("base_link",),
    ),
    Topic(
        "/power/switches",
        "diagnostic_msgs/DiagnosticArray",
        "power",
        ("plant", "drive", "arm"),
        5,
        0.5,
        "for each load: on, off, or the fraction of its power that it may draw",
        (FieldRule("status.values", "1", low=0.0, high=1.0),),
    ),
    Topic(
        "/battery_state",
        "sensor_msgs/BatteryState",
        "power",
        ("drive", "operator"),
        50,
        3.0,
        "estimated charge of the battery",
        BATTERY,
    ),
    Topic(
        "/power/status",
        "diagnostic_msgs/DiagnosticArray",
        "power",
        (),
        50,
        3.0,
        "what the power manager does and why",
        (TEXTS,),
    ),
    Topic(
        "/odom",
        "nav_msgs/Odometry",
        "drive",
        ("arm",),
        1,
        0.1,
        "estimated pose of base_link in odom with covariance, twist in base_link",
        POSE + ESTIMATED_TWIST + COVARIANCE,
        frames=("odom",),
        child_frame="base_link",
    ),
    Topic(
        "/drive/status",
        "diagnostic_msgs/DiagnosticArray",
        "drive",
        ("operator",),
        50,
        3.0,
        "goal, state, distance to go, errors on the path, energy and reason",
        (TEXTS,),
    ),
    Topic(
        "/drive_command",
        "sensor_msgs/JointState",
        "drive",
        ("plant", "arm"),
        1,
        0.2,
        "references of all joints that move the machine: rate of those that are held by it, else position and rate",
        (replace(ANGLE, optional=True), replace(RATE, optional=True)),
        joints="drive",
    ),
    Topic(
        "/arm_command",
        "sensor_msgs/JointState",
        "arm",
        ("plant",),
        1,
        0.2,
        "position, velocity and feed-forward effort of the arm's joints",
        (ANGLE, replace(RATE, optional=True), replace(EFFORT, optional=True)),
        joints="arm and tool",
    ),
    Topic(
        "/arm/status",
        "diagnostic_msgs/DiagnosticArray",
        "arm",
        ("operator",),
        50,
        3.0,
        "goal, state, progress and reason",
        (TEXTS,),
    ),
    *GOAL_TOPICS,
    Topic(
        "/operator/tick",
        "std_msgs/Header",
        "operator",
        ("plant", "drive", "arm"),
        5,
        INFINITY,
        "the scripted operator has sent all goals of this period; frame_id counts them, 'end' ends the run",
        lag=OPERATOR_LAG,
    ),
    Topic(
        "/recorder/tick",
        "std_msgs/Header",
        "recorder",
        ("plant",),
        5,
        INFINITY,
        "everything up to this period is written",
        lag=RECORDER_LAG,
        logged=False,
    ),
    Topic(
        "/diagnostics",
        "diagnostic_msgs/DiagnosticArray",
        "all",
        ("plant",),
        50,
        3.0,
        "one heartbeat a second from every node: state, messages published, received and refused",
    ),
)

_BY_NAME = {topic.name: topic for topic in TOPICS}


def topic(name: str) -> Topic:
    """Row of the table by topic name. Raises UnknownTopicError."""
    try:
        return _BY_NAME[name]
    except KeyError:
        raise UnknownTopicError(name, tuple(_BY_NAME)) from None


def outputs_of(role: str, participants: Collection[str] = ROLES) -> tuple[Topic, ...]:
    """Topics that a role publishes in a run of these roles, heartbeats included. Raises UnknownRoleError."""
    _check_role(role)
    return tuple(row for row in TOPICS if row.publisher in (role, "all") and row.is_in(participants))


def inputs_of(role: str, participants: Collection[str] = ROLES) -> tuple[Topic, ...]:
    """Topics that a role acts on in a run of these roles; for the recorder every logged one.

    Raises UnknownRoleError.
    """
    _check_role(role)
    rows = (row for row in TOPICS if row.is_in(participants))
    if role == "recorder":
        return tuple(row for row in rows if row.logged)
    return tuple(row for row in rows if role in row.subscribers)


def _check_role(role: str) -> None:
    if role not in ROLES:
        raise UnknownRoleError(role, ROLES)
