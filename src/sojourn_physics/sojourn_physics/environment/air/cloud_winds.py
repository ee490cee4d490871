"""Mean wind of a giant planet by latitude, at the level of the clouds by whose motion it is known.

    u(f) = u_0 + (u_1 - u_0) (f - f_0)/(f_1 - f_0)          between two rows, f the latitude of the vertical

Range: the latitudes of the rows and the altitudes of these clouds; beyond either no wind is told. Towards the east is
as the longitude of the body grows, so that of a body that turns westward (Uranus) a wind that runs before its rotation
is below 0.
"""

from bisect import bisect_right
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params


class LatitudeWind(Params):
    """The wind at one latitude."""

    latitude_deg: float = Field(ge=-90.0, le=90.0, description="of the vertical, north positive [deg]")
    zonal_wind: float = Field(ge=-1000.0, le=1000.0, description="mean wind towards the east [m/s]")


class CloudWinds(Params):
    """The rows from south to north."""

    lowest: float = Field(ge=-1e6, le=1e6, description="altitude of the clouds from which it is known [m]")
    highest: float = Field(ge=-1e6, le=1e6, description="and up to which [m]")
    both_sides: bool = Field(default=False, description="rows from the equator on hold south of it as well")
    rows: tuple[LatitudeWind, ...] = Field(min_length=2, description="from south to north")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.highest > self.lowest:
            raise InvalidValueError("highest", self.highest, f"above lowest, {self.lowest:g} m")
        for south, north in zip(self.rows, self.rows[1:], strict=False):
            if not north.latitude_deg > south.latitude_deg:
                raise InvalidValueError("rows", north.latitude_deg, f"north of {south.latitude_deg:g}: they go north")
        if self.both_sides and self.rows[0].latitude_deg != 0.0:
            raise InvalidValueError("both_sides", self.rows[0].latitude_deg, "a first row at the equator, 0")
        return self

    def at(self, latitude_deg: float, altitude: float) -> float | None:
        """At a latitude [deg] and an altitude [m]: [m/s]; None where it is not known.

        Raises:
            InvalidValueError: no latitude.
        """
        if not -90.0 <= latitude_deg <= 90.0:
            raise InvalidValueError("latitude [deg]", latitude_deg, "-90 to 90")
        place = abs(latitude_deg) if self.both_sides else latitude_deg
        known = self.rows[0].latitude_deg <= place <= self.rows[-1].latitude_deg
        if not (known and self.lowest <= altitude <= self.highest):
            return None
        above = min(bisect_right([row.latitude_deg for row in self.rows], place), len(self.rows) - 1)
        south, north = self.rows[above - 1], self.rows[above]
        part = (place - south.latitude_deg) / (north.latitude_deg - south.latitude_deg)
        return south.zonal_wind + part * (north.zonal_wind - south.zonal_wind)
