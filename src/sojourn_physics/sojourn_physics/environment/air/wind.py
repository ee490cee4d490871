"""Wind over the ground, and what it does to a machine.

    u(z) = u_r ln(z/z_0) / ln(z_r/z_0)     over z_0, none below        (logarithmic law of a neutral surface layer)
    F = 1/2 rho C A |u - v| (u - v)

(Stull 1988, An Introduction to Boundary Layer Meteorology, sec. 9.7; Hoerner 1965, Fluid-Dynamic Drag). u_r is the wind
at the height z_r, z_0 the roughness length: 0.2 to 10 mm on sand, 30 mm among rocks (Sullivan et al. 2000, JGR
105:24547, at the Pathfinder site). v is the velocity of the machine, C A its drag area. Assumptions: the wind is steady
and level, the force acts at the centre of mass, and the drag area is the same from all sides; no lift.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params


class WindParams(Params):
    """Wind over a scenario's ground, and the machine in it."""

    speed: float = Field(ge=0.0, le=300.0, description="at `height` [m/s]")
    towards_deg: float = Field(ge=-360.0, le=360.0, description="where it blows to, from north, east is 90 [deg]")
    drag_area: float = Field(gt=0.0, le=1000.0, description="drag coefficient times area of the machine [m2]")
    height: float = Field(default=1.5, gt=0.0, le=1000.0, description="over the ground, where its speed is known [m]")
    roughness: float = Field(default=0.01, gt=0.0, le=10.0, description="roughness length of the ground [m]")

    @model_validator(mode="after")
    def _blows_over_the_ground(self) -> Self:
        if not self.height > self.roughness:
            raise InvalidValueError("height", self.height, f"more than the roughness, {self.roughness:g} m")
        return self

    def speed_at(self, height: float) -> float:
        """At a height over the ground [m]: [m/s]."""
        if height <= self.roughness:
            return 0.0
        return self.speed * math.log(height / self.roughness) / math.log(self.height / self.roughness)


class MovingAir(NamedTuple):
    """Wind, and the air that it is made of."""

    wind: WindParams
    density: float
    """[kg/m^3]"""

    def force(self, height: float, velocity: FloatArray) -> FloatArray:
        """On the machine, in map (3,) [N].

        Args:
            height: of its centre of mass over the ground [m]. velocity: of the machine in map, (3,) [m/s].
        """
        heading, speed = math.radians(self.wind.towards_deg), self.wind.speed_at(height)
        past = np.array((speed * math.sin(heading), speed * math.cos(heading), 0.0)) - velocity
        found: FloatArray = 0.5 * self.density * self.wind.drag_area * math.sqrt(float(past @ past)) * past
        return found
