"""Two bodies with an axle each, steered by the joint between them; behind it a free joint lets them roll against each
other. base_link is the front body, above its axle; both axles stand as far from the joint, so that the rear wheels run
in the tracks of the front ones (Corke and Ridley 2001, IEEE Trans. Robotics and Automation 17:215).
"""

import math

from sojourn_config.starter.drives import DRIVING, driving, steering
from sojourn_config.starter.layout import (
    BASE,
    CARRIER_PART,
    SIDES,
    WHEEL_PART,
    StarterBody,
    StarterMachine,
    body_width,
    frames,
)
from sojourn_config.starter.size import StarterSize
from sojourn_config.starter.solids import Box, Cylinder, Link, StarterJoint

REAR, KNEE = "rear_body_link", "articulation_link"
STEERING = "articulation_joint"
ANGLE, RATE = 0.7, 0.5
"""At its stops [rad], and largest [rad/s]."""
ROLL = 0.35
"""At the stops of the roll joint [rad]."""
YAW_INERTIA = 0.1
"""Of a body about the joint, over mass of the machine times wheelbase squared, as on the articulated rover [-]."""


def articulated(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """The machine."""
    half, drop, height = 0.5 * size.wheelbase, 0.4 * size.radius, 1.2 * size.radius
    length = min(2.6 * size.radius, 1.4 * half)
    box = (length, body_width(size, 0.0), height)
    bodies = StarterBody(BASE, box, (0.0, 0.0, 0.0)), StarterBody(REAR, box, (-half, 0.0, 0.0))
    solid, mass = Cylinder(size.radius, size.width), WHEEL_PART * size.mass / size.wheels
    corners = [(f"{axle}_{side}", body, sign) for axle, body in zip(("front", "rear"), bodies, strict=True)
               for side, sign in SIDES]  # fmt: skip
    joints = tuple(f"wheel_{name}_joint" for name, _, _ in corners)
    knee = CARRIER_PART * size.mass
    drives = (
        driving(joints, size, mass * solid.inertia_per_mass[1]),
        steering((STEERING,), 0.9 * size.mass * size.gravity * size.wheelbase,
                 YAW_INERTIA * size.mass * size.wheelbase**2, DRIVING),
    )  # fmt: skip
    limit = (1.5 * drives[0].effort, size.rim_rate)
    places = [(body.at[0], sign * 0.5 * size.track, -drop) for _, body, sign in corners]
    rest = 0.5 * (size.mass - knee - mass * size.wheels)
    frame_links, frame_joints = frames(0.5 * length, 0.5 * height, with_cameras)
    return StarterMachine(
        size=size,
        links=(
            bodies[0].of_mass(rest),
            *frame_links,
            Link(KNEE, Box((0.5 * size.radius,) * 3), knee),
            bodies[1].of_mass(rest),
            *(Link(f"wheel_{name}_link", solid, mass) for name, _, _ in corners),
        ),
        joints=(
            *frame_joints,
            StarterJoint(STEERING, "revolute", BASE, KNEE, (-half, 0.0, 0.0), (0.0, 0.0, 1.0),
                  (1.3 * drives[1].effort, RATE), (-ANGLE, ANGLE)),
            StarterJoint("roll_joint", "revolute", KNEE, REAR, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 10.0),
                  (-ROLL, ROLL)),
            *(StarterJoint(joint, "continuous", body.link, f"wheel_{name}_link", place, (0.0, 1.0, 0.0), limit)
              for joint, (name, body, _), place in zip(joints, corners, places, strict=True)),
        ),
        supports=tuple(
            f"{{extends: ./wheel.yaml, name: {name}, joint: {joint}"
            + (f", steer_joint: {STEERING}}}" if body.link == REAR else "}")
            for joint, (name, body, _) in zip(joints, corners, strict=True)
        ),
        support=(f"radius: {size.radius:.4g}", f"width: {size.width:.4g}",
                 f"grouser_height: {0.045 * size.radius:.2g}", "grouser_count: 24"),
        drives=drives,
        belly=(*bodies[0].corners, *bodies[1].corners),
        front=0.5 * length,
        top=0.5 * height,
        least_radius=half / math.tan(0.5 * ANGLE),
        passive=f"{{friction_torque: {0.012 * size.mass:.2g}, viscous_friction: {0.24 * size.mass:.3g}}} # roll joint",
    )  # fmt: skip
