"""The ground as a plane in base_link."""

import math
from dataclasses import dataclass

from sojourn_machine.errors import InvalidValueError


@dataclass(frozen=True, slots=True)
class GroundPlane:
    """Half space below  normal . x = height  in base_link. The normal points up, out of the ground."""

    height: float  # [m]
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)  # unit

    def __post_init__(self) -> None:
        if not (math.isfinite(self.height) and abs(math.hypot(*self.normal) - 1.0) < 1e-3):
            raise InvalidValueError("ground plane", (self.height, self.normal), "a finite height and a unit normal")
