"""Windows by the Earth in the sky: open while it stands over the horizon of the ground, and high enough.

It is looked up for the centre of the Earth, every 10 s.
"""

import math
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.timing import NANOSECONDS
from sojourn_physics.environment.sun.earth_path import KNOT, EarthPath
from sojourn_physics.link.window import Sky, Window, WindowChoice, on_grid

_KNOT_NS = round(KNOT * NANOSECONDS)


class EarthWindowParams(WindowChoice):
    """`{kind: earth, least_elevation_deg: 10}`."""

    kind: Literal["earth"] = "earth"
    least_elevation_deg: float = Field(
        default=0.0, ge=-90.0, lt=90.0, description="over the level below which it is not pointed at [deg]"
    )

    def build(self, sky: Sky) -> Window:
        """See WindowChoice."""
        if sky.earth is None:
            raise InvalidValueError("kind", self.kind, "one with a site and a date (site, sun.time): an ephemeris")
        return EarthOverHorizon(sky, sky.earth, math.radians(self.least_elevation_deg))


@dataclass(frozen=True)
class EarthOverHorizon:
    """See `EarthWindowParams`; least elevation in radians."""

    sky: Sky
    earth: EarthPath
    least: float

    def at(self, time: int, x: float, y: float) -> tuple[bool, int]:
        """See Window."""
        begin, end = on_grid(time, _KNOT_NS)
        return self.sky.is_over_horizon(self.earth.place(begin / NANOSECONDS), x, y, self.least), end
