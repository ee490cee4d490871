"""What a machine consists of, as a value: the layouts make it, `files` writes it down."""

from dataclasses import dataclass

from sojourn_config.starter.drives import StarterDrive
from sojourn_config.starter.size import StarterSize
from sojourn_config.starter.solids import Box, Link, StarterJoint, Vector

BASE = "base_link"
SIDES = (("left", 1.0), ("right", -1.0))
WHEEL_PART, CARRIER_PART = 0.2, 0.03
"""Of the machine's mass: all wheels, as on the skid rover, and all that holds them where they steer or are sprung."""
NO_PASSIVE = "{friction_torque: 0.0, viscous_friction: 0.0} # it has none"
PITCH_OF_CAMERA = 0.5
"""Down, as on the rovers of config/machines [rad]."""


@dataclass(frozen=True)
class StarterMachine:
    """A machine.

    Args:
        size: of it. links, joints: of its URDF.
        supports: lines of machine.yaml, one a wheel or track. support: the file that they build on, its lines.
        drives: of its joints. suspension: lines of machine.yaml, none without springs.
        belly: corners of bodies, as (link, place, radius). front: of the body, x [m]. top: of it, z [m].
        least_radius: of a curve of base_link [m]; 0: it turns on the spot. soil: that it needs; "": any.
        slip: a better guess than that for wheels on soil: of what machine, mean and for each unit of grade [-].
    """

    size: StarterSize
    links: tuple[Link, ...]
    joints: tuple[StarterJoint, ...]
    supports: tuple[str, ...]
    support: tuple[str, ...]
    drives: tuple[StarterDrive, ...]
    belly: tuple[tuple[str, Vector, float], ...]
    front: float
    top: float
    suspension: tuple[str, ...] = ()
    least_radius: float = 0.0
    soil: str = ""
    passive: str = NO_PASSIVE
    slip: tuple[str, float, float] | None = None
    kind_of_support: str = "wheels"

    @property
    def turns_on_the_spot(self) -> bool:
        """Whether it can."""
        return self.least_radius == 0.0


@dataclass(frozen=True)
class StarterBody:
    """A box that carries wheels, and its axles.

    Args:
        link: its name. size: lengths [m]. at: middle in its link [m].
    """

    link: str
    size: Vector
    at: Vector

    def of_mass(self, mass: float) -> Link:
        """As a link [kg]."""
        return Link(self.link, Box(self.size), mass, self.at)

    @property
    def corners(self) -> tuple[tuple[str, Vector, float], ...]:
        """Of its underside, where it would touch the ground."""
        radius = 0.1 * self.size[2]
        (x, y, z), (length, width, height) = self.at, self.size
        return tuple(
            (self.link, (x + ahead * 0.47 * length, side * 0.45 * width + y, z - 0.5 * height + radius), radius)
            for ahead in (1.0, -1.0)
            for _, side in SIDES
        )


def body_width(size: StarterSize, turn: float) -> float:
    """Of the box between wheels that turn by so much [rad] about their middles [m]."""
    swept = 0.5 * size.width + size.radius * min(turn, 1.0)
    return max(size.track - 2.0 * swept - 0.02, 0.4 * (size.track - size.width))


def frames(front: float, top: float, with_cameras: bool) -> tuple[tuple[Link, ...], tuple[StarterJoint, ...]]:
    """Where sensors sit on base_link. front: x of the body's face, top: z of its lid [m]."""
    places = [("imu", (0.0, 0.0, 0.0), 0.0)]
    if with_cameras:
        places += [("hazcam", (front + 0.02, 0.0, 2.0 * top + 0.1), PITCH_OF_CAMERA), ("sun", (0.0, 0.0, top), 0.0)]
    links = tuple(Link(f"{name}_link") for name, _, _ in places)
    joints = tuple(
        StarterJoint(f"{name}_joint", "fixed", BASE, f"{name}_link", at, pitch=pitch) for name, at, pitch in places
    )
    return links, joints
