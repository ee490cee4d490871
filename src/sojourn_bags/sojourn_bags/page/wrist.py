"""Figures of the forces on the arm's tool: what its wrist felt, and what the ground truly did to it."""

import numpy as np

from sojourn_bags.curves import COLORS
from sojourn_bags.page.chart import ChartLine, chart, wheel_curves
from sojourn_bags.page.html import figure
from sojourn_bags.page.story import CLOUD, Story

WRENCH = "geometry_msgs/msg/WrenchStamped"
AXES = ("x", "y", "z")


def wrist_figures(story: Story) -> list[str]:
    """Force and moment at the wrist, and the contact of the arm's pads; empty where the bag tells of none."""
    messages = story.find("/wrist/wrench", WRENCH)
    if messages is None:
        return []
    times = story.times(messages)
    force, moment = (messages.columns(*(f"wrench.{kind}.{axis}" for axis in AXES)) for kind in ("force", "torque"))
    if not np.isfinite(force).any():
        return []
    note = "In the frame of the sensor; the tool's own weight is in it."
    parts = [figure("Force at the wrist", chart(story.axis, wheel_curves(times, force, AXES), "force [N]"), note)]
    contact = _contact(story)
    if contact:
        title = "True force of the ground on the arm's tool"
        parts.append(figure(title, chart(story.axis, contact, "force [N]")))
    parts.append(figure("Moment at the wrist", chart(story.axis, wheel_curves(times, moment, AXES), "moment [N m]")))
    return parts


def _contact(story: Story) -> list[ChartLine]:
    """Upward and level force of the ground on pads of the arm, where they have touched it."""
    contacts = story.find("/truth/contacts", CLOUD)
    if contacts is None or story.run is None:
        return []
    names = [pad.name for pad in story.run.machine.pads if pad.link.startswith("arm_")]
    places = [len(story.wheels) + story.pads.index(name) for name in names]
    points = story.points
    if not {"force_x", "force_y", "force_z"} <= points.keys() or not places:
        return []
    up = points["force_z"][:, places].sum(axis=1)
    level = np.hypot(points["force_x"][:, places], points["force_y"][:, places]).sum(axis=1)
    if not np.nan_to_num(np.abs(up) + level).any():
        return []
    times = story.times(contacts)
    return [ChartLine(times, up, "upward", COLORS[0]), ChartLine(times, level, "level", COLORS[1])]
