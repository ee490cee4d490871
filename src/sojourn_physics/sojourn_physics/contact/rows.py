"""Rows of the kernels, from the wheels and pads of a machine."""

import math
from collections.abc import Sequence

import numpy as np

from sojourn_machine.contact_choice import ContactChoice
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import PadParams, ScoopParams, WheelParams
from sojourn_physics.contact.contact_law import WHEEL_COLUMNS, WheelColumn
from sojourn_physics.contact.law_call import row_entry
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.pad_on_soil import CUT_COLUMNS, FIRST_CUT, IS_TOOL
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


def kernel_rows(wheels: Sequence[WheelParams], pads: Sequence[PadParams], gravity: float) -> FloatArray:
    """Rows of wheels and then of pads for the kernels: shape (len(wheels) + len(pads), WHEEL_COLUMNS).

    Args:
        gravity: where the machine is [m/s^2].
    """
    rows = np.zeros((len(wheels) + len(pads), WHEEL_COLUMNS))
    rows[:, WheelColumn.GRAVITY] = gravity
    for row, wheel in zip(rows, wheels, strict=False):
        row[WheelColumn.RADIUS] = wheel.radius
        row[WheelColumn.SHEAR_RADIUS] = wheel.shear_radius
        row[WheelColumn.WIDTH] = wheel.width
        row[WheelColumn.GROUSER_HEIGHT] = wheel.grouser_height if wheel.grouser_count else 0.0
        row[WheelColumn.GROUSER_COUNT] = wheel.grouser_count
        law = law_of(wheel.contact)
        row[WheelColumn.LAW] = row_entry(law.law())
        law.fill(row)
    for row, pad in zip(rows[len(wheels) :], pads, strict=True):
        row[WheelColumn.RADIUS] = pad.radius
        row[WheelColumn.WIDTH] = pad.scoop.width if pad.scoop is not None else 0.0
        row[IS_TOOL] = float(pad.is_tool)
    return rows


def add_cuts(rows: FloatArray, pads: Sequence[PadParams], soils: Sequence[SoilParams], gravity: float) -> None:
    """Write how pads with a scoop cut each soil into their rows, the last of `rows`: see `pad_on_soil`.

    Raises:
        InvalidValueError: more soils than a row has room for.
    """
    room = (WHEEL_COLUMNS - FIRST_CUT) // CUT_COLUMNS
    for row, pad in zip(rows[len(rows) - len(pads) :], pads, strict=True):
        if pad.scoop is None:
            continue
        if len(soils) > room:
            raise InvalidValueError(f"soils under the scoop {pad.name}", len(soils), f"at most {room}")
        for number, soil in enumerate(soils):
            first = FIRST_CUT + CUT_COLUMNS * number
            row[first : first + CUT_COLUMNS] = cut_of(pad.scoop, soil, gravity)
