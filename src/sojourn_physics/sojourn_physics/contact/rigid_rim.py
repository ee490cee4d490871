"""A rigid rim and how it stands in the ground: what the stresses under it are integrated from (`wheel_on_soil`)."""

from typing import NamedTuple

from sojourn_machine.params import FloatArray


class RigidRim(NamedTuple):
    """Shape of a wheel that does not give way."""

    radius: float
    """Of the rim, r [m]."""
    shear_radius: float
    """Of the circle through the tips of the grousers, r_s; that of the rim where it is bare [m]."""
    width: float
    """b [m]."""
    grouser_count: float = 0.0
    """N [-]."""
    grouser_thickness: float = 0.0
    """Along the rim, t [m]."""


class RimContact(NamedTuple):
    """How a rim stands in the ground and moves over it."""

    depth: float
    """Of the lowest point of the undeformed rim below the ground plane [m]."""
    slip: float
    """s of the rim, -1..1 [-]."""
    lateral_slip: float = 0.0
    """s_y, -1..1 [-]."""
    rolling: float = 1.0
    """|D|, 0: pressed straight down, 1: steady rolling [-]."""


class Travel(NamedTuple):
    """Motion behind a slip and a lateral slip, all over V = max(|rω|, |v|) [-]."""

    rim_speed: float
    ahead: float
    """v_x."""
    total_slip: float
    """s' against the whole speed over the ground."""
    sideways: float
    """e: how much of the way is sideways, 0..1."""


class Quadrature(NamedTuple):
    """A rule of integration on (0, 1), each (m,)."""

    nodes: FloatArray
    weights: FloatArray
