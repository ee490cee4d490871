"""Rules of fields that several rows of the topic table share: unit, plausible range, tolerance of a replay."""

from dataclasses import replace

from sojourn_contract.topic_types import FieldRule

RATE = FieldRule("velocity", "rad/s", low=-200.0, high=200.0)
MEASURED_RATE = replace(RATE, rate_of="position", rate_tolerance=0.05, rate_part=0.05)
ENCODER_RATE = replace(
    MEASURED_RATE, rate_tolerance=0.08, rate_part=0.0, rate_window=5
)  # a count of 12 bits in a period
ANGLE = FieldRule("position", "rad", low=-1e6, high=1e6)
TORQUE_TOLERANCE = 1e-7
"""Of torques [N m], which are some hundred times larger than the angles that they follow from."""
FORCE_TOLERANCE = 1e-6
FLOAT32_TOLERANCE = 1e-5
"""Of fields that the type declares as float32: above its spacing up to 128."""
EFFORT = FieldRule("effort", "N m", low=-1e4, high=1e4, tolerance=TORQUE_TOLERANCE)
WRENCH = (
    FieldRule("wrench.force", "N", "its sensor", low=-1e4, high=1e4, tolerance=FORCE_TOLERANCE, optional=True),
    FieldRule("wrench.torque", "N m", "its sensor", low=-1e4, high=1e4, tolerance=TORQUE_TOLERANCE, optional=True),
)
TEXTS = FieldRule("status.values", "")
POSE = (
    FieldRule("pose.pose.position", "m", low=-1e5, high=1e5),
    FieldRule("pose.pose.orientation", "", low=-1.0, high=1.0),
)
COVARIANCE = (FieldRule("pose.covariance", ""), FieldRule("twist.covariance", ""))
TWIST = (
    FieldRule(
        "twist.twist.linear",
        "m/s",
        frame="base_link",
        low=-50.0,
        high=50.0,
        rate_of="pose.pose.position",
        rate_tolerance=0.02,
    ),
    FieldRule(
        "twist.twist.angular",
        "rad/s",
        frame="base_link",
        low=-50.0,
        high=50.0,
        rate_of="pose.pose.orientation",
        rate_tolerance=0.02,
    ),
)
TRUE_TWIST = (
    replace(TWIST[0], rate_spread="twist.covariance"),
    replace(TWIST[1], rate_spread="twist.covariance", rate_spread_place=3),
    FieldRule("twist.covariance", "(m/s)^2, (rad/s)^2", low=0.0, high=100.0),
)
ESTIMATED_TWIST = (TWIST[0], replace(TWIST[1], rate_tolerance=0.5))  # roll and pitch are set anew, not integrated
GOAL_FRAMES = ("map", "odom", "base_link")
GOAL = (
    FieldRule("pose.position", "m", frame="map, odom or base_link", low=-1e4, high=1e4),
    FieldRule("pose.orientation", "", low=-1.0, high=1.0),
)
PLACE = (
    FieldRule("pose.pose.position", "m", frame="map or odom", low=-1e4, high=1e4),
    FieldRule("pose.pose.orientation", "", low=-1.0, high=1.0),
    FieldRule("pose.covariance", "m^2, rad^2", low=-1e8, high=1e8),
)
BATTERY = (
    FieldRule("voltage", "V", low=0.0, high=100.0, tolerance=FLOAT32_TOLERANCE),
    FieldRule("current", "A, negative while discharging", low=-500.0, high=500.0, tolerance=FLOAT32_TOLERANCE),
    FieldRule("temperature", "degree Celsius", low=-150.0, high=150.0, tolerance=FLOAT32_TOLERANCE),
    FieldRule("charge", "Ah", low=0.0, high=1000.0, tolerance=FLOAT32_TOLERANCE, optional=True),
    FieldRule("capacity", "Ah", low=0.0, high=1000.0, tolerance=FLOAT32_TOLERANCE, optional=True),
    FieldRule("percentage", "1", low=0.0, high=1.0, tolerance=1e-7, optional=True),
)
