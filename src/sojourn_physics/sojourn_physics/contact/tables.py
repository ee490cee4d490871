"""What the kernels of the contacts are given, as a few values with names."""

from typing import NamedTuple

import numpy as np

from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.contact.contact_law import MOTION_COLUMNS, OUT_COLUMNS
from sojourn_physics.contact.ground_memory import PAST_COLUMNS
from sojourn_physics.terrain.height_field import HeightArray, SoilArray
from sojourn_physics.terrain.memory_tiles import MemoryTables

FRAME_VECTORS = 6


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


class Workspace(NamedTuple):
    """What the kernels write while they go from contact to contact."""

    body: Body
    meeting: Meeting
    twist: FloatArray
    """(6,): velocities of the point of a body at the map's origin."""
    wrench: FloatArray
    """(6,): force and moment on a body."""
    out: FloatArray
    """Row of `OutColumn`."""
    vectors: FloatArray
    """(3, 3): a pad's normal, its slide and the shear that it feels."""


class Touch(NamedTuple):
    """What the kernels of the contacts write."""

    states: FloatArray
    """(contacts, STATE_COLUMNS), advanced in place."""
    report: FloatArray
    """(contacts, REPORT_COLUMNS)"""
    force: FloatArray
    """(nv,): generalised force, added to."""
    workspace: Workspace


def make_workspace(soils: FloatArray) -> Workspace:
    """For a ground of these soils, (soils, columns)."""
    twist = np.zeros(6)
    meeting = Meeting(
        frame=np.zeros((FRAME_VECTORS, 3)),
        motion=np.zeros(MOTION_COLUMNS),
        shares=np.zeros(len(soils)),
        soil=np.zeros(soils.shape[1]),
        past=np.zeros(PAST_COLUMNS),
    )
    body = Body(np.zeros(3), np.zeros(3), np.zeros(3), twist[3:])
    return Workspace(body, meeting, twist, np.zeros(6), np.zeros(OUT_COLUMNS), np.zeros((3, 3)))
