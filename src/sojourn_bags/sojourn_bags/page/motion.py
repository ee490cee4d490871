"""Sections about motion: wheels on the ground, attitude, position, margin against tipping over."""

import numpy as np

from sojourn_bags.curves import COLORS, FloatArray
from sojourn_bags.machine import euler_angles
from sojourn_bags.messages import Messages
from sojourn_bags.page.chart import ChartLine, chart, wheel_curves
from sojourn_bags.page.html import PageSection, figure, paragraph
from sojourn_bags.page.story import CLOUD, IMU, JOINTS, POSE, Story
from sojourn_bags.true_slip import WHERE_IT_STANDS, true_slip

MER_CLASS_DEG = 45.0
"""Tilt at which the Mars Exploration Rovers still stand (Lindemann and Voorhees 2005)."""
_QUATERNION = tuple(f"orientation.{axis}" for axis in "xyzw")


HEADINGS = {"wheel": "Wheels", "track": "Tracks", "foot": "Feet", "support": "Supports"}


def wheels(story: Story) -> PageSection:
    """Slip, sinkage, loads and torques of what it stands on."""
    contacts = story.find("/truth/contacts", CLOUD)
    if contacts is None or story.run is None:
        return PageSection(
            "wheels", "Wheels", paragraph("The bag has no true contacts of a known machine on /truth/contacts.")
        )
    times, parts = story.times(contacts), []
    drives = [wheel.joint for wheel in story.run.machine.rolling]
    driven = story.moved(drives)
    word = story.run.machine.support_word
    if not driven:
        parts.append(paragraph(f"No {word} has turned: slip and drive torque are left out."))
    count = len(story.wheels)

    def draw(title: str, values: FloatArray, label: str, note: str = "") -> None:
        parts.append(figure(title, chart(story.axis, wheel_curves(times, values, story.wheels), label), note))

    if driven and story.find("/truth/odom", POSE) and {"slip_ratio", "slip_angle"} <= story.points.keys():
        note = f"1: it turns on the spot; 0: it rolls; below: it skids; {WHERE_IT_STANDS}."
        ratio, angle = (true_slip(story.bag, story.run, field) for field in ("slip_ratio", "slip_angle"))
        draw(f"Slip of each {word}", ratio, "slip ratio [-]", note)
        draw(f"Slip angle of each {word}", np.degrees(angle), "slip angle [degree]", f"{WHERE_IT_STANDS.capitalize()}.")
    if "sinkage" in story.points:
        draw(f"Sinkage of each {word}", 1000.0 * story.points["sinkage"][:, :count], "sinkage [mm]")
    if "force_z" in story.points:
        draw(f"Upward contact force of each {word}", story.points["force_z"][:, :count], "force [N]")
        level = np.hypot(story.points["force_x"], story.points["force_y"])
        draw(f"Horizontal contact force of each {word}", level[:, :count], "force [N]")
        parts.append(_pads(story, times, HEADINGS[word].lower()))
    parts.append(_torques(story, drives if driven else [], f"Torque of the {word} drives"))
    steered = list(story.run.machine.steer_joints)
    parts.append(_torques(story, steered if story.moved(steered) else [], "Torque of the steering joints"))
    return PageSection("wheels", HEADINGS[word], "".join(parts))


def _pads(story: Story, times: FloatArray, supports: str) -> str:
    """Forces on what else touches the ground than its supports: belly, deck, arm."""
    count = len(story.wheels)
    forces = np.sqrt(sum(story.points[f"force_{axis}"][:, count:] ** 2 for axis in "xyz"))
    pads = [(name, forces[:, column]) for column, name in enumerate(story.pads) if column < forces.shape[1]]
    touched = [(name, force) for name, force in pads if np.nanmax(np.append(force, 0.0)) > 0.0]
    if not touched:
        return paragraph(f"Nothing but the {supports} has touched the ground.", quiet=True)
    curves = [ChartLine(times, force, name.replace("_", " "), COLORS[number % len(COLORS)], number // len(COLORS))
              for number, (name, force) in enumerate(touched)]  # fmt: skip
    return figure("Contact force of what else has touched the ground", chart(story.axis, curves, "force [N]"))


def _torques(story: Story, joints: list[str], title: str) -> str:
    states, found = story.find("/truth/joint_states", JOINTS), story.true_joints
    known = [name for name in joints if found is not None and name in found.names]
    if states is None or found is None or not known:
        return ""
    values = found.effort[:, [found.index(name) for name in known]]
    names = [name.removesuffix("_joint").split("_", 1)[-1] for name in known]
    return figure(title, chart(story.axis, wheel_curves(story.times(states), values, names), "torque [N m]"))


def attitude(story: Story) -> PageSection:
    """Roll, pitch and yaw, true and estimated; error of the estimated position; margin against tipping over."""
    sources: list[tuple[str, Messages, FloatArray]] = []
    for topic, name in (("/truth/odom", "true"), ("/odom", "odometry")):
        messages = story.find(topic, POSE)
        if messages is not None:
            columns = messages.columns(*(f"pose.pose.{part}" for part in _QUATERNION))
            sources.append((name, messages, np.degrees(euler_angles(columns))))
    imu = story.find("/imu/data", IMU)
    if imu is not None:
        sources.append(("inertial unit", imu, np.degrees(euler_angles(imu.columns(*_QUATERNION)))))
    if not sources:
        text = "The bag has neither /truth/odom nor /odom nor /imu/data of the usual types."
        return PageSection("attitude", "Attitude and position", paragraph(text))
    parts = []
    for number, angle in enumerate(("Roll", "Pitch", "Yaw")):
        curves = [
            ChartLine(story.times(messages), values[:, number], name, COLORS[index], index)
            for index, (name, messages, values) in enumerate(sources)
        ]
        parts.append(figure(angle, chart(story.axis, curves, f"{angle.lower()} [degree]", height=150.0)))
    parts.append(_position_error(story))
    parts.append(_margin(story))
    return PageSection("attitude", "Attitude, position and tip-over margin", "".join(parts))


def _position_error(story: Story) -> str:
    truth, belief = story.find("/truth/odom", POSE), story.find("/odom", POSE)
    if truth is None or belief is None:
        missing = "/truth/odom" if truth is None else "/odom"
        return paragraph(f"The error of the estimated position cannot be known: {missing} is not in the bag.")
    _, rows, others = np.intersect1d(truth.times, belief.times, return_indices=True)
    if not rows.size:
        return paragraph("No two messages of /truth/odom and /odom have the same stamp.")
    place = [f"pose.pose.position.{axis}" for axis in "xyz"]
    error = belief.columns(*place)[others] - truth.columns(*place)[rows]
    times = story.times(truth)[rows]
    heading = np.degrees(_yaw(belief)[others] - _yaw(truth)[rows])
    plane = [ChartLine(times, 1000.0 * np.hypot(error[:, 0], error[:, 1]), "in the plane")]
    turned = [ChartLine(times, heading, "heading")]
    return figure(
        "Distance of the estimated from the true position", chart(story.axis, plane, "error [mm]", height=150.0)
    ) + (figure("Estimated less true heading", chart(story.axis, turned, "error [degree]", height=130.0)))


def _yaw(messages: Messages) -> FloatArray:
    return euler_angles(messages.columns(*(f"pose.pose.{part}" for part in _QUATERNION)))[:, 2]


def _margin(story: Story) -> str:
    title = "Static tip-over margin"
    if story.margin is None:
        return paragraph(
            "The tip-over margin cannot be known: that takes the machine and its true contacts and joints."
        )
    note = (
        "Angle by which the line of gravity, through the true centre of mass, is inside the outline of what carries; "
        "at 0 the rover tips. A gap: fewer than three supports carry, or they stand in a line."
    )
    curves = [ChartLine(story.margin.times, np.degrees(story.margin.values), "least over all edges")]
    marks = [(MER_CLASS_DEG, f"{MER_CLASS_DEG:.0f}°: rovers of the MER class, on the level")]
    return figure(title, chart(story.axis, curves, "margin [degree]", marks), note)
