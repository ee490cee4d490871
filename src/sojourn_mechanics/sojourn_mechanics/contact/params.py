"""Parameters of what touches the ground: wheels, and pads on bodies."""

import math
from collections.abc import Sequence
from typing import Annotated, TypeAlias

import numpy as np
from pydantic import Field

from sojourn_mechanics.contact.bekker_wheel import BekkerWheelParams
from sojourn_mechanics.contact.brush import BrushParams
from sojourn_mechanics.contact.compliant_wheel_on_soil import CompliantWheelOnSoilParams
from sojourn_mechanics.contact.contact_law import WHEEL_COLUMNS, WheelColumn
from sojourn_mechanics.contact.firm_wheel_laws import (
    CompliantWheelOnRigidGroundParams,
    RigidWheelOnRigidGroundParams,
    WheelAndGroundInSeriesParams,
)
from sojourn_mechanics.contact.magic_formula import MagicFormulaParams
from sojourn_mechanics.contact.pad_on_soil import CUT_COLUMNS, FIRST_CUT, IS_TOOL
from sojourn_mechanics.contact.rigid_wheel_on_soil import RigidWheelOnSoilParams
from sojourn_mechanics.contact.roller_wheel import RollerWheelParams
from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray, Params
from sojourn_mechanics.soil.digging import CutCoefficients, DiggingSoil, cut_coefficients
from sojourn_mechanics.soil.params import SoilParams

ContactParams: TypeAlias = Annotated[
    RigidWheelOnSoilParams
    | BekkerWheelParams
    | CompliantWheelOnSoilParams
    | RigidWheelOnRigidGroundParams
    | WheelAndGroundInSeriesParams
    | CompliantWheelOnRigidGroundParams
    | BrushParams
    | MagicFormulaParams
    | RollerWheelParams,
    Field(discriminator="model"),
]
"""A contact law with its own parameters; the key `model` says which."""


class WheelParams(Params):
    """One wheel."""

    name: str = Field(min_length=1, description="name of the wheel")
    joint: str = Field(min_length=1, description="drive joint, about the wheel's axle")
    steer_joint: str | None = Field(default=None, description="steering joint, or none")
    radius: float = Field(gt=0.0, le=5.0, description="radius of the rim, without grousers [m]")
    width: float = Field(gt=0.0, le=3.0, description="width of the rim [m]")
    grouser_height: float = Field(default=0.0, ge=0.0, le=0.2, description="height of the grousers [m]")
    grouser_count: int = Field(default=0, ge=0, le=500, description="number of grousers on the rim [-]")
    contact: ContactParams = Field(default=RigidWheelOnSoilParams(), description="contact model and its own parameters")

    @property
    def shear_radius(self) -> float:
        """Radius of the circle on which the soil shears [m]: the tips of the grousers, if there are any."""
        return self.radius + (self.grouser_height if self.grouser_count else 0.0)


class ScoopParams(Params):
    """A tool whose end is a pad, and whose flank cuts the soil like a blade: see `soil.digging`."""

    width: float = Field(gt=0.0, le=2.0, description="of the cut [m]")
    rake_deg: float = Field(default=90.0, ge=20.0, le=120.0, description="rake angle of the flank [degree]")
    tool_friction_deg: float = Field(default=15.0, ge=0.0, le=45.0, description="of soil on the tool [degree]")

    def coefficients(self, soil: SoilParams, gravity: float) -> CutCoefficients:
        """Of the cut in a soil; zero in a rigid one, which is not cut."""
        friction = math.radians(soil.friction_angle_deg)
        if soil.kind == "rigid" or friction <= 0.0:
            return CutCoefficients(0.0, 0.0, 0.0, 0.0, 0.0)
        on_tool = min(math.radians(self.tool_friction_deg), friction)
        seen = DiggingSoil(soil.density * gravity, soil.cohesion, friction, on_tool)
        return cut_coefficients(seen, self.width, math.radians(self.rake_deg))


class PadParams(Params):
    """A round pad on a body: where the chassis, the mast or the arm's tip would touch the ground."""

    name: str = Field(min_length=1, description="name of the pad")
    link: str = Field(min_length=1, description="link of the URDF that carries it")
    position: tuple[float, float, float] = Field(description="centre of the pad in the link's frame, shape (3,) [m]")
    radius: float = Field(gt=0.0, le=2.0, description="radius of the pad [m]")
    scoop: ScoopParams | None = Field(default=None, description="what it cuts the soil with when dragged, or nothing")
    is_tool: bool = Field(
        default=False, description="whether it is the end of the arm's tool: it meets what has been dug"
    )


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
        row[WheelColumn.MODEL] = wheel.contact.number
        wheel.contact.fill(row)
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
            row[first : first + CUT_COLUMNS] = pad.scoop.coefficients(soil, gravity)
