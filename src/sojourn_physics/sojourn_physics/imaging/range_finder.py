"""Range finders: one beam, or a cone of which the nearest return is read: laser, ultrasound, radar altimeter.

A cone is felt by beams that share its solid angle evenly, the first along its axis, the last on its rim: on the spiral
of a sunflower's seeds (Vogel 1979, Math. Biosci. 44:179), with the same step of the cosine from seed to seed. Each
hears by the range equation of `ranging` as if its target filled the whole cone; what is read is the nearest return, as
of a pulse whose leading edge is tracked. So a small stone within a wide cone is heard from farther than it would be.
Light comes back by the albedo. Radio waves and sound do not: for them the reflectance of what they meet is given, for
radar on dry soil about that of Fresnel's equations, ((sqrt ε - 1)/(sqrt ε + 1))², 0.07 for ε = 3.
"""

import math
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ranging import WIDEST, Beams, RangingParams, is_heard, measured

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
"""[rad]"""
Radiation = Literal["infrared", "ultrasound", "radar"]


class RangeFinderParams(RangingParams):
    """What a data sheet says."""

    radiation: Radiation = Field(default="infrared", description="infrared (any light), ultrasound or radar")
    field_of_view_deg: float = Field(
        default=0.0, ge=0.0, le=120.0, description="whole angle of its cone, 0 for a single beam [degree]"
    )
    beams: int = Field(default=100, ge=7, le=10_000, description="beams that stand for the cone [-]")
    target_reflectance: float | None = Field(
        default=None, gt=0.0, le=1.0, description="of all that it meets [-]; left out: the albedo, as light has it"
    )

    @model_validator(mode="after")
    def _check_radiation(self) -> Self:
        if self.radiation != "infrared" and self.target_reflectance is None:
            raise ValueError(
                f"no target_reflectance: needed with radiation = {self.radiation}, for the albedo is that of light"
            )
        return self


def cone_of(params: RangeFinderParams) -> Beams:
    """The beams about x."""
    if params.field_of_view_deg == 0.0:
        directions, spacing = np.array([[1.0, 0.0, 0.0]]), WIDEST
    else:
        seed = np.arange(params.beams)
        opening = 1.0 - math.cos(math.radians(0.5 * params.field_of_view_deg))
        along = 1.0 - opening * seed / (params.beams - 1)
        aside, turn = np.sqrt(1.0 - along**2), GOLDEN_ANGLE * seed
        directions = np.stack([along, aside * np.cos(turn), aside * np.sin(turn)], axis=1)
        spacing = min(math.sqrt(2.0 * math.pi * opening / params.beams), WIDEST)
    return Beams(directions, spacing, params.reach, params.target_reflectance)


def nearest_return(
    params: RangeFinderParams, distance: FloatArray, returned: FloatArray, random: np.random.Generator
) -> float:
    """What is read of all beams together [m]; infinite where it is no distance, see `ranging`.

    Args:
        distance, returned: as `echoes.echoes` has them, (n,).
    """
    heard = np.where(is_heard(params, distance, returned), distance, math.inf)
    first = int(np.argmin(heard))
    return float(measured(params, heard[[first]], returned[[first]], random)[0])
