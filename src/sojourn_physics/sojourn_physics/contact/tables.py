"""What the kernels of the supports are given, as a few values with names: a table for each kind of support."""

from typing import NamedTuple

import numpy as np

from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.contact.contact_law import MOTION_COLUMNS, OUT_COLUMNS
from sojourn_physics.contact.ground_memory import PAST_COLUMNS
from sojourn_physics.terrain.height_field import HeightArray, SoilArray
from sojourn_physics.terrain.memory_tiles import MemoryTables

FRAME_VECTORS = 6


class Carried(NamedTuple):
    """Where the supports of one kind hang on a machine."""

    bodies: IntArray
    """(n,): index of the joint that carries each."""
    chains: IntArray
    """(n, depth): columns of the Jacobian that move it, filled with -1."""
    offsets: FloatArray
    """(n, 3): its point in the joint's frame [m]."""
    first: int
    """Row of the first of them in the report."""


class WheelTable(NamedTuple):
    """Wheels: their axle is the y axis of their joint."""

    rows: FloatArray
    """(wheels, WHEEL_COLUMNS), see `contact_law`."""
    carried: Carried


class TrackTable(NamedTuple):
    """Tracks in plates, from the front of the first track to its rear, then the next; see `track_on_soil`."""

    rows: FloatArray
    """(tracks, TRACK_COLUMNS)"""
    belts: IntArray
    """(tracks, 3): velocity column of the sprocket, first plate, number of plates."""
    plates: FloatArray
    """(plates, PLATE_COLUMNS)"""
    carried: Carried
    """Its offsets are the middles of the flat runs."""


class FootTable(NamedTuple):
    """Feet of legs: they stand on the z axis of their frame, ahead is its x axis."""

    rows: FloatArray
    """(feet, WHEEL_COLUMNS), see `contact_law`."""
    frames: FloatArray
    """(feet, 3, 3): x, y, z axes of a foot in the frame of the joint that carries it."""
    carried: Carried


class PadTable(NamedTuple):
    """Pads on bodies; see `pad_on_soil`."""

    radii: FloatArray
    """(pads,) [m]"""
    cuts: FloatArray
    """(pads, soils, CUT_COLUMNS): how a scoop cuts each soil; zero where it does not."""
    tools: FloatArray
    """(pads, TOOL_COLUMNS): what a tool on the pad does; the tool writes it before each period."""
    carried: Carried


class Supports(NamedTuple):
    """All that meets the ground, a table for each kind."""

    wheels: WheelTable
    tracks: TrackTable
    feet: FootTable
    pads: PadTable


class SupportStates(NamedTuple):
    """What the supports of each kind remember."""

    wheels: FloatArray
    """(wheels, STATE_COLUMNS), see `contact_law`."""
    tracks: FloatArray
    """(plates of all tracks, STATE_COLUMNS), see `track_on_soil`."""
    feet: FloatArray
    """(feet, STATE_COLUMNS)"""
    pads: FloatArray
    """(pads, STATE_COLUMNS), see `pad_on_soil`."""

    def copy(self) -> "SupportStates":
        """One that shares no array with this."""
        return SupportStates(*(states.copy() for states in self))


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
    """A support in map, each (3,)."""

    centre: FloatArray
    """[m]"""
    axle: FloatArray
    """Unit vector."""
    velocity: FloatArray
    """Of the centre [m/s]."""
    angular_velocity: FloatArray
    """[rad/s]"""


class Meeting(NamedTuple):
    """How a wheel, or another support with a law, meets the ground."""

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
    """What the kernels write while they go from support to support."""

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
    """What the kernels of the supports write."""

    states: SupportStates
    """Advanced in place."""
    report: FloatArray
    """(supports, REPORT_COLUMNS)"""
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
