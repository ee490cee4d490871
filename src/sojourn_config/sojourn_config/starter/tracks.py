"""Two tracks on a rigid hull: both ends of each rise by 40 degrees to wheels of the sprocket's size, as on the tracked
rover.
"""

import math

from sojourn_config.starter.drives import driving
from sojourn_config.starter.layout import BASE, SIDES, StarterBody, StarterMachine, frames
from sojourn_config.starter.size import StarterSize
from sojourn_config.starter.solids import Box, Cylinder, Link, StarterJoint

TRACK_PART, SPROCKET_PART = 0.25, 0.06
"""Of the machine's mass: both tracks, both sprockets."""
RISE_DEG = 40.0


def tracks(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """The machine; its wheelbase is the flat run."""
    radius, run = size.radius, size.wheelbase
    hull = StarterBody(BASE, (run + 2.0 * radius, size.track - size.width - 0.06, 2.0 * radius), (0.0, 0.0, 0.0))
    solid, mass = Cylinder(radius, size.width), 0.5 * SPROCKET_PART * size.mass
    frame = Box((run + 3.0 * radius, size.width, 1.8 * radius))
    sunk = -1.4 * radius
    joints = tuple(f"track_{side}_joint" for side, _ in SIDES)
    drives = (driving(joints, size, mass * solid.inertia_per_mass[1]),)
    sprocket = (0.5 * run + radius * math.cos(math.radians(RISE_DEG)), 0.0, 0.1 * radius)
    frame_links, frame_joints = frames(0.5 * hull.size[0], radius, with_cameras)
    return StarterMachine(
        size=size,
        links=(
            hull.of_mass((1.0 - TRACK_PART - SPROCKET_PART) * size.mass),
            *frame_links,
            *(Link(f"track_{side}_link", frame, 0.5 * TRACK_PART * size.mass) for side, _ in SIDES),
            *(Link(f"sprocket_{side}_link", solid, mass) for side, _ in SIDES),
        ),
        joints=(
            *frame_joints,
            *(StarterJoint(f"track_{side}_mount", "fixed", BASE, f"track_{side}_link",
                           (0.0, sign * 0.5 * size.track, sunk))
              for side, sign in SIDES),
            *(StarterJoint(joint, "continuous", f"track_{side}_link", f"sprocket_{side}_link", sprocket,
                           (0.0, 1.0, 0.0), (1.5 * drives[0].effort, size.rim_rate))
              for joint, (side, _) in zip(joints, SIDES, strict=True)),
        ),
        supports=tuple(
            f"{{extends: ./track.yaml, name: {side}, joint: track_{side}_joint, link: track_{side}_link}}"
            for side, _ in SIDES
        ),
        support=(
            f"position: [0.0, 0.0, {-1.1 * radius:.4g}]",
            f"radius: {radius:.4g}",
            f"width: {size.width:.4g}",
            f"length: {run:.4g}",
            *(f"{end}: {{angle_deg: {RISE_DEG}, length: {radius:.4g}, radius: {radius:.4g}}}"
              for end in ("front", "rear")),
            "road_wheels: 5",
            "peakedness: 0.5",
        ),
        drives=drives,
        belly=hull.corners,
        front=0.5 * hull.size[0],
        top=radius,
        kind_of_support="tracks",
        slip=("tracked", 0.001, 0.06),
    )  # fmt: skip
