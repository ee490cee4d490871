"""Air as measured, by altitude: temperature linear between the rows of a table, pressure as a gas at rest has it there.

    T = T_0 + L (h - h_0),    p = p_0 (T/T_0)^-n,    n = -ln(p_1/p_0) / ln(T_1/T_0)    (n = g/(R L) of a gas at rest)
    p = p_0 exp(-(h - h_0)/H),    where T_1 = T_0

Exact in the rows. Altitudes may be geopotential, h = r z/(r + z) for a height z over a body of radius r, for which
a gas at rest under a gravity that falls with height has this law (U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562,
eq. 18, 33a and 33b). Range: the rows.
"""

import math
from bisect import bisect_right
from typing import Any, Literal, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_physics.environment.air.atmosphere import Air, AtmosphereParams
from sojourn_physics.environment.air.cloud_winds import CloudWinds

SAME = 1e-9
"""Two temperatures nearer than this are one, over the lower [1]."""


class AirRow(Params):
    """The air at one altitude."""

    altitude: float = Field(ge=-1e6, le=1e6, description="over the reference ellipsoid, or geopotential [m]")
    temperature: float = Field(gt=0.0, le=5000.0, description="[K]")
    pressure: float = Field(gt=0.0, le=1e9, description="[Pa]")
    zonal_wind: float | None = Field(
        default=None, ge=-1000.0, le=1000.0, description="mean wind towards the east; none: not known [m/s]"
    )


class TabulatedParams(AtmosphereParams):
    """The rows from below upwards."""

    kind: Literal["tabulated"] = Field(default="tabulated", description="this kind")
    rows: tuple[AirRow, ...] = Field(min_length=2, description="from below upwards")
    geopotential_radius: float | None = Field(
        default=None, gt=0.0, le=1e9, description="r, where altitudes of the rows are geopotential [m]"
    )
    cloud_winds: CloudWinds | None = Field(
        default=None, description="wind by latitude, where the rows have none; none: not known"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As its file: most have no winds by latitude."""
        return {key: value for key, value in dump(self).items() if value is not None or key != "cloud_winds"}

    @model_validator(mode="after")
    def _goes_up(self) -> Self:
        for below, above in zip(self.rows, self.rows[1:], strict=False):
            if not (above.altitude > below.altitude and above.pressure < below.pressure):
                allowed = f"higher than {below.altitude:g} m with less than {below.pressure:g} Pa: rows go upwards"
                raise InvalidValueError("rows", (above.altitude, above.pressure), allowed)
        if self.cloud_winds is not None and any(row.zonal_wind is not None for row in self.rows):
            raise InvalidValueError("cloud_winds", "a table", "none beside rows that have a zonal_wind")
        return self

    @property
    def altitudes(self) -> tuple[float, float]:
        """Of the lowest and the highest row [m]."""
        return self._height(self.rows[0].altitude), self._height(self.rows[-1].altitude)

    def at(self, altitude: float) -> Air:
        """The air at an altitude [m]."""
        height = self._checked(altitude)
        if self.geopotential_radius is not None:
            height = self.geopotential_radius * height / (self.geopotential_radius + height)
        above = min(max(bisect_right([row.altitude for row in self.rows], height), 1), len(self.rows) - 1)
        low, high = self.rows[above - 1], self.rows[above]
        part = (height - low.altitude) / (high.altitude - low.altitude)
        temperature = low.temperature + part * (high.temperature - low.temperature)
        fall = math.log(high.pressure / low.pressure)
        if abs(high.temperature - low.temperature) > SAME * low.temperature:
            part_of_fall = math.log(temperature / low.temperature) / math.log(high.temperature / low.temperature)
        else:
            part_of_fall = part
        return self._of(temperature, low.pressure * math.exp(fall * part_of_fall), _between(low, high, part))

    def over(self, latitude_deg: float, altitude: float) -> Air:
        """With the wind of the latitude, where winds are known by it."""
        found = self.at(altitude)
        if self.cloud_winds is None:
            return found
        return found._replace(zonal_wind=self.cloud_winds.at(latitude_deg, altitude))

    def _height(self, altitude: float) -> float:
        """Over the ellipsoid, of an altitude in the table [m]."""
        if self.geopotential_radius is None:
            return altitude
        return self.geopotential_radius * altitude / (self.geopotential_radius - altitude)


def _between(low: AirRow, high: AirRow, part: float) -> float | None:
    """Wind at a part of the way from one row to the next [m/s]; None where either has none, but in a row itself."""
    if low.zonal_wind is None or high.zonal_wind is None:
        return low.zonal_wind if part == 0.0 else high.zonal_wind if part == 1.0 else None
    return low.zonal_wind + part * (high.zonal_wind - low.zonal_wind)
