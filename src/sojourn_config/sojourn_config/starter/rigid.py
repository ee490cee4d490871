"""Wheels on one frame: fixed, steered in front, or all steered; with rollers; on springs where there are over four.

ackermann       every axle but the last is steered, so that all wheels roll about one point on the last axle's line,
                above which base_link stands
all             every wheel is steered far enough to turn on the spot: |angle| = atan(x / (track / 2))
springs         each wheel on a guide along z, whose spring gives a quarter of the wheel's radius under its load;
                damping 0.3 of the critical one. Four wheels on soil share the load without.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sojourn_config.starter.drives import STEER_RATE, driving, rim_effort, steering
from sojourn_config.starter.layout import (
    BASE,
    CARRIER_PART,
    NO_PASSIVE,
    SIDES,
    WHEEL_PART,
    StarterBody,
    StarterMachine,
    body_width,
    frames,
)
from sojourn_config.starter.size import StarterSize
from sojourn_config.starter.solids import ORIGIN, Box, Cylinder, Link, StarterJoint, Vector

ACKERMANN_ANGLE = 0.7
"""At the stops of steered wheels of a machine that does not turn on the spot [rad]."""
SPARE_ANGLE = 0.15
"""Beyond what turning on the spot takes [rad]."""
SAG = 0.25
"""Of a spring under its load, in radii of the wheel [-]."""
DAMPING = 0.3
UP: Vector = (0.0, 0.0, 1.0)
ROLLER_DEG = 45.0
ROLLER_STIFFNESS = 1.0e5 / 32.0
"""Of a Mecanum wheel over the load on it, as on the omni rover [1/m]."""


@dataclass(frozen=True)
class _Corner:
    """A wheel: where it stands, and what it hangs on."""

    name: str
    place: Vector
    steered: bool
    sprung: bool

    def parts(self, wheel: Link, carrier: float, limits: "_Limits") -> Iterator[tuple[Link, StarterJoint]]:
        """Its links, each with the joint above it. carrier: mass of each that holds it [kg]."""
        parent, at = BASE, self.place
        block = Box((0.4 * limits.radius,) * 3)
        if self.sprung:
            slide = Link(f"slide_{self.name}_link", block, carrier)
            stops = (-SAG * limits.radius, 2.0 * SAG * limits.radius)
            yield slide, StarterJoint(self.suspension_joint, "prismatic", parent, slide.name, at, UP, (0.0, 5.0), stops)
            parent, at = slide.name, ORIGIN
        if self.steered:
            knuckle = Link(f"knuckle_{self.name}_link", block, carrier)
            limit = (limits.steer_effort, STEER_RATE)
            stops = (-limits.steer_angle, limits.steer_angle)
            yield knuckle, StarterJoint(self.steer_joint, "revolute", parent, knuckle.name, at, UP, limit, stops)
            parent, at = knuckle.name, ORIGIN
        turning = (0.0, 1.0, 0.0)
        yield wheel, StarterJoint(self.wheel_joint, "continuous", parent, wheel.name, at, turning, limits.wheel)

    @property
    def wheel_joint(self) -> str:
        """About its axle."""
        return f"wheel_{self.name}_joint"

    @property
    def steer_joint(self) -> str:
        """About z."""
        return f"steer_{self.name}_joint"

    @property
    def suspension_joint(self) -> str:
        """Along z."""
        return f"suspension_{self.name}_joint"


@dataclass(frozen=True)
class _Limits:
    """Of the joints: radius of a wheel [m], effort and velocity [N m], [rad/s], angle [rad]."""

    radius: float
    wheel: tuple[float, float]
    steer_effort: float
    steer_angle: float


def skid(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """Fixed wheels, the sides at different rates."""
    return _rigid(size, with_cameras, 0, 0.0, 0.5 * size.wheelbase)


def ackermann(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """Every axle but the last is steered."""
    return _rigid(size, with_cameras, size.axles - 1, ACKERMANN_ANGLE, 0.0)


def all_wheel(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """Every axle is steered."""
    angle = math.atan2(0.5 * size.wheelbase, 0.5 * size.track) + SPARE_ANGLE
    return _rigid(size, with_cameras, size.axles, angle, 0.5 * size.wheelbase)


def omni(size: StarterSize, with_cameras: bool) -> StarterMachine:
    """Mecanum wheels, whose rollers make an X seen from above."""
    return _rigid(size, with_cameras, 0, 0.0, 0.5 * size.wheelbase, rollers=True)


def axle_names(axles: int) -> tuple[str, ...]:
    """From the first to the last."""
    known = {2: ("front", "rear"), 3: ("front", "middle", "rear")}
    return known.get(axles, tuple(f"axle_{number}" for number in range(1, axles + 1)))


def _rigid(
    size: StarterSize, with_cameras: bool, steered: int, angle: float, base: float, rollers: bool = False
) -> StarterMachine:
    """steered: axles from the first on. angle: at their stops [rad]. base: base_link ahead of the last axle [m]."""
    sprung, drop = size.axles > 2, 0.4 * size.radius
    corners = [
        _Corner(f"{name}_{side}", (x - base, sign * 0.5 * size.track, -drop), axle < steered, sprung)
        for axle, (name, x) in enumerate(zip(axle_names(size.axles), size.axle_places, strict=True))
        for side, sign in SIDES
    ]
    height = 1.2 * size.radius
    middle = 0.5 * size.wheelbase - base
    body = StarterBody(BASE, (size.wheelbase + 0.8 * size.radius, body_width(size, angle), height), (middle, 0.0, 0.0))
    solid, mass = Cylinder(size.radius, size.width), WHEEL_PART * size.mass / size.wheels
    carrier = CARRIER_PART * size.mass / size.wheels
    spin = mass * solid.inertia_per_mass[1]
    drives = [driving(tuple(corner.wheel_joint for corner in corners), size, spin)]
    steer_joints = tuple(corner.steer_joint for corner in corners if corner.steered)
    if steer_joints:
        drives.append(steering(steer_joints, rim_effort(size) / 1.5, mass * solid.inertia_per_mass[0]))
    limits = _Limits(size.radius, (1.5 * drives[0].effort, size.rim_rate), 1.3 * drives[-1].effort, angle)
    parts = [
        part
        for corner in corners
        for part in corner.parts(Link(f"wheel_{corner.name}_link", solid, mass), carrier, limits)
    ]
    front = body.at[0] + 0.5 * body.size[0]
    frame_links, frame_joints = frames(front, 0.5 * height, with_cameras)
    rest = size.mass - sum(link.mass for link, _ in parts)
    return StarterMachine(
        size=size,
        links=(body.of_mass(rest), *frame_links, *(link for link, _ in parts)),
        joints=(*frame_joints, *(joint for _, joint in parts)),
        supports=tuple(_support(corner, rollers) for corner in corners),
        support=_wheel(size, rollers),
        drives=tuple(drives),
        belly=body.corners,
        front=front,
        top=0.5 * height,
        suspension=_suspension(size, corners, rest) if sprung else (),
        passive=_guides(size) if sprung else NO_PASSIVE,
        least_radius=_least_radius(size, angle) if 0 < steered < size.axles else 0.0,
        soil="rigid_rock" if rollers else "",
        slip=("omni", 0.001, 0.04) if rollers else None,
    )


def _least_radius(size: StarterSize, angle: float) -> float:
    """Of the middle of the last axle [m], where the inner wheel of the first is at its stop."""
    return size.wheelbase / math.tan(angle) + 0.5 * size.track


def _support(corner: _Corner, rollers: bool) -> str:
    steer = f", steer_joint: {corner.steer_joint}" if corner.steered else ""
    contact = ""
    if rollers:
        outward = corner.place[0] * corner.place[1] > 0.0
        contact = f", contact: {{roller_angle_deg: {-ROLLER_DEG if outward else ROLLER_DEG}}}"
    return f"{{extends: ./wheel.yaml, name: {corner.name}, joint: {corner.wheel_joint}{steer}{contact}}}"


def _wheel(size: StarterSize, rollers: bool) -> tuple[str, ...]:
    lines = (f"radius: {size.radius:.4g}", f"width: {size.width:.4g}")
    if rollers:
        return (*lines, f"contact: {{model: roller_wheel, stiffness: {ROLLER_STIFFNESS * size.load:.3g}}}")
    return (*lines, f"grouser_height: {0.045 * size.radius:.2g}", "grouser_count: 24")


def _guides(size: StarterSize) -> str:
    return (
        f"{{friction_torque: {0.01 * size.load:.2g}, viscous_friction: 0.0}} # guides of the springs, an estimate [N]"
    )


def _suspension(size: StarterSize, corners: list[_Corner], sprung_mass: float) -> tuple[str, ...]:
    share = sprung_mass / size.wheels
    sag = SAG * size.radius
    stiffness = share * size.gravity / sag
    damping = 2.0 * DAMPING * math.sqrt(stiffness * share)
    names = ", ".join(corner.suspension_joint for corner in corners)
    return (
        f"joints: [{names}]",
        f"stiffness: {stiffness:.4g} # [N/m]",
        f"damping: {damping:.3g} # {DAMPING:g} of the critical one [N s/m]",
        f"rest: {-share * size.gravity / float(f'{stiffness:.4g}'):.5g} # carries the machine at zero pose [m]",
    )
