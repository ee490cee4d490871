"""What the kernels of the contacts are given, as a few values with names."""

from typing import NamedTuple

from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.terrain.height_field import HeightArray, SoilArray
from sojourn_physics.terrain.memory_tiles import MemoryTables


class Contacts(NamedTuple):
    """All that can touch the ground: wheels first, then pads."""

    rows: FloatArray
    """(contacts, WHEEL_COLUMNS), see `contact_law` and `pad_on_soil`."""
    bodies: IntArray
    """(contacts,): index of the joint that carries the contact."""
    supports: IntArray
    """(contacts, depth): columns of the Jacobian that move it, filled with -1."""
    offsets: FloatArray
    """(contacts, 3): point in the joint's frame [m]."""
    wheel_count: int
    """The first so many are wheels, whose axle is the y axis of their joint."""


class Ground(NamedTuple):
    """The ground that they touch."""

    heights: HeightArray
    """See `HeightField`, these three."""
    soil_index: SoilArray
    grid: FloatArray
    soils: FloatArray
    """(soils, columns): rows of `SoilColumn`."""
    memory: MemoryTables
    """Advanced in place."""


class Kinematics(NamedTuple):
    """Where a machine is, and how it moves."""

    placements: FloatArray
    """(joints, 12): rotation (columns one after another) and position of each joint in map."""
    jacobian: FloatArray
    """(6, nv), of the machine at the map's origin, linear rows first."""
    velocity: FloatArray
    """(nv,)"""


class Body(NamedTuple):
    """A wheel or a pad in map, each (3,)."""

    centre: FloatArray
    """[m]"""
    axle: FloatArray
    """Unit vector."""
    velocity: FloatArray
    """Of the centre [m/s]."""
    angular_velocity: FloatArray
    """[rad/s]"""


class Meeting(NamedTuple):
    """How a wheel meets the ground, written by `wheel_contact`."""

    frame: FloatArray
    """(FRAME_VECTORS, 3): forward, up, in-plane (from the lowest point of the rim to the centre), and the contact
    frame: along, side, normal.
    """
    motion: FloatArray
    """Row of `MotionColumn`."""
    shares: FloatArray
    """(soils,): weight of each soil in the contact."""
    soil: FloatArray
    """Row of `SoilColumn`: the ground there."""
    past: FloatArray
    """(PAST_COLUMNS,): what that ground has seen (see `ground_memory`)."""
