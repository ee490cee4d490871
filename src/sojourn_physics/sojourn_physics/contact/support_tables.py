"""Tables of the supports of a machine for the kernels, hung on its multibody."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray, IntArray
from sojourn_machine.supports import FootParams, PadParams, TrackParams
from sojourn_physics.contact.contact_law import STATE_COLUMNS
from sojourn_physics.contact.pad_on_soil import TOOL_COLUMNS, ToolColumn
from sojourn_physics.contact.rows import foot_rows, pad_cuts, track_plates, track_rows, wheel_rows
from sojourn_physics.contact.tables import (
    Carried,
    FootTable,
    PadTable,
    Supports,
    SupportStates,
    TrackTable,
    WheelTable,
)
from sojourn_physics.contact.track_on_soil import PlateColumn
from sojourn_physics.soil.params import SoilParams


class StandingPoints(NamedTuple):
    """The points on which a machine stands on plane ground."""

    bodies: tuple[int, ...]
    """Joint that carries each."""
    offsets: FloatArray
    """(n, 3): in that joint's frame [m]."""
    below: tuple[float, ...]
    """How far under its point each meets the ground [m]: a wheel's radius."""


@dataclass(frozen=True, slots=True)
class SupportTables:
    """The supports of a machine.

    Args:
        names: of all, in the order of the report. tables: for the kernels. standing: what it stands on.
    """

    names: tuple[str, ...]
    tables: Supports
    standing: StandingPoints

    @property
    def bodies(self) -> IntArray:
        """(supports,): joint that carries each, in the order of the report."""
        return np.concatenate([table.carried.bodies for table in self.tables])

    def first_states(self) -> SupportStates:
        """Of supports that touch nothing yet."""
        counts = (len(table) for table in (
            self.tables.wheels.rows, self.tables.tracks.plates, self.tables.feet.rows, self.tables.pads.radii
        ))  # fmt: skip
        return SupportStates(*(np.zeros((count, STATE_COLUMNS)) for count in counts))


def support_tables(
    multibody: pin.Model, machine: MachineParams, soils: Sequence[SoilParams], gravity: float
) -> SupportTables:
    """Tables of a machine.

    Args:
        soils: of the ground, in the order of its kernel rows. gravity: [m/s^2].

    Raises:
        InvalidValueError: a joint or a link that the URDF does not have, a track that hangs on its own sprocket.
    """
    hung = [
        [(_joint(multibody, wheel.joint, "wheel " + wheel.name), np.zeros(3)) for wheel in machine.wheels],
        [_on_link(multibody, "track", track) for track in machine.tracks],
        [_on_link(multibody, "foot", foot) for foot in machine.feet],
        [_on_link(multibody, "pad", pad) for pad in machine.pads],
    ]
    for wheel in machine.wheels:
        if wheel.steer_joint is not None:
            _joint(multibody, wheel.steer_joint, "wheel " + wheel.name)
    first = np.cumsum([0, *map(len, hung)])
    wheels, tracks, feet, pads = (
        _carried(multibody, one, int(start)) for one, start in zip(hung, first[:-1], strict=True)
    )
    tables = Supports(
        WheelTable(wheel_rows(machine.wheels, gravity), wheels),
        _track_table(multibody, machine.tracks, tracks, gravity),
        FootTable(foot_rows(machine.feet, gravity), _axes(multibody, machine.feet), feet),
        PadTable(
            np.array([pad.radius for pad in machine.pads]), pad_cuts(machine.pads, soils, gravity),
            _tools(machine.pads), pads,
        ),
    )  # fmt: skip
    return SupportTables(
        tuple(support.name for support in machine.supports), tables, _standing(multibody, machine, tables)
    )


def _joint(multibody: pin.Model, name: str, of: str) -> int:
    if not multibody.existJointName(name):
        raise InvalidValueError(f"joint of {of}", name, "one of " + ", ".join(multibody.names[2:]))
    return int(multibody.getJointId(name))


def _frame(multibody: pin.Model, kind: str, support: TrackParams | FootParams | PadParams) -> pin.Frame:
    if not multibody.existFrame(support.link):
        raise InvalidValueError(f"link of {kind} {support.name}", support.link, "a link of the URDF")
    return multibody.frames[multibody.getFrameId(support.link)]


def _on_link(multibody: pin.Model, kind: str, support: TrackParams | FootParams | PadParams) -> tuple[int, FloatArray]:
    """Joint that carries a support, and its point in that joint's frame."""
    frame = _frame(multibody, kind, support)
    return int(frame.parentJoint), frame.placement.act(np.array(support.position))


def _carried(multibody: pin.Model, hung: Sequence[tuple[int, FloatArray]], first: int) -> Carried:
    chains = [_chain(multibody, body) for body, _ in hung]
    columns = np.full((len(hung), max(map(len, chains), default=0) + 1), -1, dtype=np.int64)
    for row, chain in zip(columns, chains, strict=True):
        row[: len(chain)] = chain
    bodies = np.array([body for body, _ in hung], dtype=np.int64)
    offsets = np.ascontiguousarray(np.reshape([offset for _, offset in hung], (-1, 3)), dtype=np.float64)
    return Carried(bodies, columns, offsets, first)


def _chain(multibody: pin.Model, joint: int) -> list[int]:
    """Velocity columns that move a joint, base first."""
    chain: list[int] = []
    while joint > 0:
        start = multibody.joints[joint].idx_v
        chain = list(range(start, start + multibody.joints[joint].nv)) + chain
        joint = multibody.parents[joint]
    return chain


def _track_table(multibody: pin.Model, tracks: Sequence[TrackParams], carried: Carried, gravity: float) -> TrackTable:
    belts = np.zeros((len(tracks), 3), dtype=np.int64)
    plates: list[FloatArray] = []
    for belt, track, body, middle in zip(belts, tracks, carried.bodies, carried.offsets, strict=True):
        sprocket = _joint(multibody, track.joint, "track " + track.name)
        if sprocket == body:
            raise InvalidValueError(
                f"link of track {track.name}", track.link, "one that does not turn with the sprocket"
            )
        rotation = _frame(multibody, "track", track).placement.rotation
        own = track_plates(track)
        for columns, shift in ((slice(PlateColumn.X, PlateColumn.Z + 1), middle), (_AHEAD, np.zeros(3))):
            own[:, columns] = own[:, columns] @ rotation.T + shift
        belt[:] = multibody.joints[sprocket].idx_v, sum(map(len, plates)), len(own)
        plates.append(own)
    rows = np.concatenate(plates) if plates else np.zeros((0, len(PlateColumn)))
    return TrackTable(track_rows(tracks, gravity), belts, np.ascontiguousarray(rows), carried)


_AHEAD = slice(PlateColumn.AHEAD_X, PlateColumn.AHEAD_Z + 1)


def _axes(multibody: pin.Model, feet: Sequence[FootParams]) -> FloatArray:
    axes = [_frame(multibody, "foot", foot).placement.rotation.T for foot in feet]
    return np.ascontiguousarray(np.reshape(axes, (-1, 3, 3)), dtype=np.float64)


def _tools(pads: Sequence[PadParams]) -> FloatArray:
    rows = np.zeros((len(pads), TOOL_COLUMNS))
    rows[:, ToolColumn.IS_TOOL] = [float(pad.is_tool) for pad in pads]
    return rows


def _standing(multibody: pin.Model, machine: MachineParams, tables: Supports) -> StandingPoints:
    """Centres of wheels, both ends of the flat runs of tracks, soles of feet."""
    points = [
        (int(body), np.zeros(3), wheel.radius)
        for body, wheel in zip(tables.wheels.carried.bodies, machine.wheels, strict=True)
    ]
    for track in machine.tracks:
        frame = _frame(multibody, "track", track)
        for end in (0.5, -0.5):
            place = np.array(track.position) + np.array([end * track.length, 0.0, 0.0])
            points.append((int(frame.parentJoint), frame.placement.act(place), 0.0))
    for foot in machine.feet:
        points.append((*_on_link(multibody, "foot", foot), 0.0))
    return StandingPoints(
        tuple(body for body, _, _ in points),
        np.reshape([offset for _, offset, _ in points], (-1, 3)),
        tuple(below for _, _, below in points),
    )
