"""Point spectrometers: the name of a soil by its spectrum, now and then a wrong one.

What names the soil, an algorithm behind a spectrometer, is described as such algorithms are: by its confusion matrix,
for each soil that there is the probability of each name that it is given (Congalton 1991, Remote Sens. Environ. 37:35).
It needs light: the Sun's, or that of a lamp of its own.
"""

import math
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.params import Params

ROUNDING = 1e-6
"""Of the sum of a row [-]."""


class SpectrometerParams(Params):
    """What it is told by."""

    range: float = Field(gt=0.0, le=100.0, description="longest distance from which it tells a soil [m]")
    spot_deg: float = Field(default=1.0, gt=0.0, le=30.0, description="whole angle of the spot that it sees [degree]")
    lamp: bool = Field(default=False, description="whether it has a lamp of its own [-]")
    least_radiance: float = Field(
        default=1.0, gt=0.0, le=1e4, description="light of the spot that it needs without a lamp [W/m2/sr]"
    )
    confusion: dict[str, dict[str, float]] = Field(
        min_length=1, description="for each soil the probability of each name that it gives it; each row sums to 1 [-]"
    )

    @model_validator(mode="after")
    def _check_rows(self) -> Self:
        for soil, names in self.confusion.items():
            for name, probability in names.items():
                if not 0.0 <= probability <= 1.0:
                    raise ValueError(f"confusion.{soil}.{name} = {probability}: allowed is 0 to 1")
            total = math.fsum(names.values())
            if abs(total - 1.0) > ROUNDING:
                raise ValueError(f"confusion.{soil} sums to {total:g}: allowed is 1")
        return self


def named(params: SpectrometerParams, soil: str, random: np.random.Generator) -> str:
    """The name that a soil of `confusion` is given."""
    names = params.confusion[soil]
    luck = random.random() * math.fsum(names.values())
    for name, probability in names.items():
        luck -= probability
        if luck < 0.0:
            return name
    return max(names, key=lambda name: names[name])  # rounding has left something of the luck
