"""Rows of the kernels, from the supports of a machine."""

import math
from collections.abc import Sequence

import numpy as np

from sojourn_machine.contact_choice import ContactChoice
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import FootParams, PadParams, ScoopParams, TrackEndParams, TrackParams, WheelParams
from sojourn_physics.contact.contact_law import WHEEL_COLUMNS, WheelColumn
from sojourn_physics.contact.law_call import row_entry
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.pad_on_soil import CUT_COLUMNS
from sojourn_physics.contact.track_on_soil import PLATE_COLUMNS, TRACK_COLUMNS, PlateColumn, TrackColumn
from sojourn_physics.soil.digging import CutCoefficients, DiggingSoil, cut_coefficients
from sojourn_physics.soil.params import SoilParams


def law_of(choice: ContactChoice) -> ContactLawParams:
    """The contact law that was chosen. Raises InvalidValueError where what is registered under its name is none."""
    if not isinstance(choice, ContactLawParams):
        raise InvalidValueError("contact model", choice.model, "a law derived from ContactLawParams")
    return choice


def cut_of(scoop: ScoopParams, soil: SoilParams, gravity: float) -> CutCoefficients:
    """Coefficients of the cut in a soil at a gravity [m/s^2]; zero in a rigid one, which is not cut."""
    friction = math.radians(soil.friction_angle_deg)
    if soil.kind == "rigid" or friction <= 0.0:
        return CutCoefficients(0.0, 0.0, 0.0, 0.0, 0.0)
    on_tool = min(math.radians(scoop.tool_friction_deg), friction)
    seen = DiggingSoil(soil.density * gravity, soil.cohesion, friction, on_tool)
    return cut_coefficients(seen, scoop.width, math.radians(scoop.rake_deg))


def wheel_rows(wheels: Sequence[WheelParams], gravity: float) -> FloatArray:
    """Rows of wheels for the kernels: shape (wheels, WHEEL_COLUMNS).

    Args:
        gravity: where the machine is [m/s^2].
    """
    rows = np.zeros((len(wheels), WHEEL_COLUMNS))
    for row, wheel in zip(rows, wheels, strict=True):
        row[WheelColumn.RADIUS] = wheel.radius
        row[WheelColumn.SHEAR_RADIUS] = wheel.shear_radius
        row[WheelColumn.WIDTH] = wheel.width
        row[WheelColumn.GROUSER_HEIGHT] = wheel.grouser_height if wheel.grouser_count else 0.0
        row[WheelColumn.GROUSER_COUNT] = wheel.grouser_count
        _fill_law(row, law_of(wheel.contact), gravity)
    return rows


def foot_rows(feet: Sequence[FootParams], gravity: float) -> FloatArray:
    """Rows of feet for the kernels: shape (feet, WHEEL_COLUMNS); gravity as above."""
    rows = np.zeros((len(feet), WHEEL_COLUMNS))
    for row, foot in zip(rows, feet, strict=True):
        row[WheelColumn.RADIUS] = row[WheelColumn.SHEAR_RADIUS] = foot.radius
        _fill_law(row, law_of(foot.contact), gravity)
    return rows


def _fill_law(row: FloatArray, law: ContactLawParams, gravity: float) -> None:
    row[WheelColumn.GRAVITY] = gravity
    row[WheelColumn.LAW] = row_entry(law.law())
    law.fill(row)


def track_rows(tracks: Sequence[TrackParams], gravity: float) -> FloatArray:
    """Rows of tracks for the kernels: shape (tracks, TRACK_COLUMNS); gravity as above."""
    rows = np.zeros((len(tracks), TRACK_COLUMNS))
    for row, track in zip(rows, tracks, strict=True):
        row[TrackColumn.RADIUS] = track.radius
        row[TrackColumn.WIDTH] = track.width
        row[TrackColumn.PITCH] = track.length / track.plates
        row[TrackColumn.LENGTH] = track.length
        row[TrackColumn.PEAKEDNESS] = track.peakedness
        row[TrackColumn.GRAVITY] = gravity
    return rows


def track_plates(track: TrackParams) -> FloatArray:
    """Plates of a track from its front to its rear, (plates, PLATE_COLUMNS), about the middle of the flat run: x ahead,
    z up. All have the pitch of the flat run's.
    """
    pitch = track.length / track.plates
    ahead = 0.5 - (np.arange(track.plates) + 0.5) / track.plates
    flat = np.zeros((track.plates, PLATE_COLUMNS))
    flat[:, PlateColumn.X] = track.length * ahead
    flat[:, PlateColumn.AHEAD_X] = 1.0
    flat[:, PlateColumn.SHARE] = 1.0 - track.peakedness * np.cos(2.0 * np.pi * track.road_wheels * (ahead + 0.5))
    front, rear = (_rising(end, pitch) for end in (track.front, track.rear))
    front[:, PlateColumn.X] += 0.5 * track.length
    rear[:, PlateColumn.X] = -0.5 * track.length - rear[:, PlateColumn.X]
    rear[:, PlateColumn.AHEAD_Z] *= -1.0
    return np.concatenate([front[::-1], flat, rear])


def _rising(end: TrackEndParams, pitch: float) -> FloatArray:
    """Plates from the end of the flat run upwards, until the track is upright; x and z from there [m]."""
    angle = math.radians(end.angle_deg)
    count = round((end.length + end.radius * (0.5 * math.pi - angle)) / pitch)
    passed = pitch * (np.arange(count) + 0.5)
    straight = np.minimum(passed, end.length)
    turned = angle + (passed - straight) / end.radius
    plates = np.zeros((count, PLATE_COLUMNS))
    plates[:, PlateColumn.X] = straight * math.cos(angle) + end.radius * (np.sin(turned) - math.sin(angle))
    plates[:, PlateColumn.Z] = straight * math.sin(angle) + end.radius * (math.cos(angle) - np.cos(turned))
    plates[:, PlateColumn.AHEAD_X] = np.cos(turned)
    plates[:, PlateColumn.AHEAD_Z] = np.sin(turned)
    plates[:, PlateColumn.SHARE] = 1.0
    return plates


def pad_cuts(pads: Sequence[PadParams], soils: Sequence[SoilParams], gravity: float) -> FloatArray:
    """How pads with a scoop cut each soil, (pads, soils, CUT_COLUMNS): see `pad_on_soil`; zero for those without."""
    cuts = np.zeros((len(pads), len(soils), CUT_COLUMNS))
    for by_soil, pad in zip(cuts, pads, strict=True):
        if pad.scoop is not None:
            by_soil[:] = [cut_of(pad.scoop, soil, gravity) for soil in soils]
    return cuts
