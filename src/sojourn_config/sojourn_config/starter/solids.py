"""Links and joints of a URDF, the inertias from uniform solids, and the text of the file.

Moments of inertia about the centre (Goldstein 1980, Classical Mechanics, ch. 5):
    box:        I_xx = m (b^2 + c^2) / 12,  and so round
    cylinder:   I_yy = m r^2 / 2 about its axis,  I_xx = I_zz = m (3 r^2 + l^2) / 12
"""

from collections.abc import Sequence
from dataclasses import dataclass

Vector = tuple[float, float, float]
ORIGIN: Vector = (0.0, 0.0, 0.0)
ABOUT_Y = "1.5707963267948966 0 0"
"""Roll, pitch, yaw of a cylinder of URDF whose axis is y [rad]."""


@dataclass(frozen=True)
class Box:
    """Lengths along x, y, z [m]."""

    size: Vector

    @property
    def inertia_per_mass(self) -> Vector:
        """Principal moments over the mass, about x, y, z [m^2]."""
        a, b, c = (length**2 / 12.0 for length in self.size)
        return b + c, a + c, a + b

    def urdf(self, at: Vector) -> str:
        """Its place and shape."""
        return f'<origin xyz="{_text(at)}"/><geometry><box size="{_text(self.size)}"/></geometry>'


@dataclass(frozen=True)
class Cylinder:
    """About y [m]."""

    radius: float
    length: float

    @property
    def inertia_per_mass(self) -> Vector:
        """Principal moments over the mass, about x, y, z [m^2]."""
        across = (3.0 * self.radius**2 + self.length**2) / 12.0
        return across, 0.5 * self.radius**2, across

    def urdf(self, at: Vector) -> str:
        """Its place and shape."""
        shape = f'<cylinder radius="{_number(self.radius)}" length="{_number(self.length)}"/>'
        return f'<origin xyz="{_text(at)}" rpy="{ABOUT_Y}"/><geometry>{shape}</geometry>'


@dataclass(frozen=True)
class Link:
    """A link; without a solid a frame. mass: [kg]. at: centre of its solid in it [m]."""

    name: str
    solid: Box | Cylinder | None = None
    mass: float = 0.0
    at: Vector = ORIGIN

    def urdf(self) -> str:
        """Its element."""
        if self.solid is None:
            return f'  <link name="{self.name}"/>'
        xx, yy, zz = (_number(self.mass * part) for part in self.solid.inertia_per_mass)
        shape = self.solid.urdf(self.at)
        return "\n".join(
            (
                f'  <link name="{self.name}">',
                f'    <inertial><origin xyz="{_text(self.at)}"/><mass value="{_number(self.mass)}"/>',
                f'      <inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/></inertial>',
                f"    <visual>{shape}</visual>",
                f"    <collision>{shape}</collision>",
                "  </link>",
            )
        )


@dataclass(frozen=True)
class StarterJoint:
    """A joint. at: of its frame in that of its parent [m]. pitch: of it there [rad].

    limit: effort [N m] or [N], velocity [rad/s] or [m/s]. stops: lower, upper [rad] or [m]; None: it turns on.
    """

    name: str
    kind: str
    parent: str
    child: str
    at: Vector
    axis: Vector = ORIGIN
    limit: tuple[float, float] | None = None
    stops: tuple[float, float] | None = None
    pitch: float = 0.0

    def urdf(self) -> str:
        """Its element."""
        turn = f' rpy="0 {_number(self.pitch)} 0"' if self.pitch else ""
        lines = [
            f'  <joint name="{self.name}" type="{self.kind}">',
            f'    <parent link="{self.parent}"/><child link="{self.child}"/><origin xyz="{_text(self.at)}"{turn}/>',
        ]
        if self.limit is not None:
            effort, velocity = map(_number, self.limit)
            stops = "" if self.stops is None else 'lower="{}" upper="{}" '.format(*map(_number, self.stops))
            lines.append(f'    <axis xyz="{_text(self.axis)}"/><limit {stops}effort="{effort}" velocity="{velocity}"/>')
        return "\n".join([*lines, "  </joint>"])


def urdf_text(name: str, words: str, links: Sequence[Link], joints: Sequence[StarterJoint]) -> str:
    """The whole file. words: for its head."""
    parts = [*(link.urdf() for link in links), *(joint.urdf() for joint in joints)]
    return "\n".join(['<?xml version="1.0"?>', f"<!-- {words} -->", f'<robot name="{name}">', *parts, "</robot>", ""])


def _text(vector: Vector) -> str:
    return " ".join(map(_number, vector))


def _number(value: float) -> str:
    """To seven figures, and no minus before a zero."""
    return f"{round(value, 12) + 0.0:.7g}"
