"""Windows by the passes of an orbiter that relays: open while it stands over the horizon of the ground.

    r = a [cos W cos u - sin W sin u cos i,  sin W cos u + cos W sin u cos i,  sin u sin i]
    u = u_0 + n t,    W = W_0 + (dW/dt - w) t

in the axes of the body, which turns at w: a circular orbit of radius a and inclination i, u the angle from its
ascending node, whose east longitude W drifts by the body's flattening (`environment.orbit.circular`). Looked up every
second. Source: Vallado (2013), Fundamentals of Astrodynamics and Applications, sections 2.6 and 9.6. The orbiter has
the Earth in view and passes on at once what it hears: light times are those to the Earth, and what its own way to the
machine adds, 2 ms for 600 km, is left out. Range: passes drift by some seconds a day, as an orbiter's own eccentricity,
upkeep and drag are not known.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.timing import NANOSECONDS
from sojourn_physics.environment.orbit.circular import CircularOrbit, Flattening
from sojourn_physics.environment.site import SiteFrame
from sojourn_physics.link.window import Sky, Window, WindowChoice, on_grid


class OrbiterParams(WindowChoice):
    """`{kind: orbiter, altitude_km: 300, inclination_deg: 92.6, node_longitude_deg: 30}`."""

    kind: Literal["orbiter"] = "orbiter"
    altitude_km: float = Field(gt=0.0, le=1e6, description="over the mean radius of the body [km]")
    inclination_deg: float = Field(ge=0.0, le=180.0, description="against the equator [deg]")
    node_longitude_deg: float = Field(
        ge=-180.0, le=360.0, description="east longitude of the ascending node at the start of the run [deg]"
    )
    from_node_deg: float = Field(
        default=0.0, ge=-360.0, le=360.0, description="angle of the orbiter from that node at the start [deg]"
    )
    least_elevation_deg: float = Field(
        default=10.0, ge=-90.0, lt=90.0, description="over the level below which it is not heard [deg]"
    )

    def build(self, sky: Sky) -> Window:
        """See WindowChoice."""
        if sky.frame is None:
            raise InvalidValueError("kind", self.kind, "one with a site, which passes go over")
        radius, inclination = sky.body.radius + 1e3 * self.altitude_km, math.radians(self.inclination_deg)
        orbit = CircularOrbit(sky.body.gravitational_parameter, sky.body.radius, radius)
        attraction = sky.body.attraction
        j2, reference = getattr(attraction, "j2", 0.0), getattr(attraction, "reference_radius", None)
        drift = Flattening(j2, reference or sky.body.radius).node_rate(orbit, inclination)
        turning = 0.0 if sky.body.rotation is None else sky.body.rotation.rate
        node, angle = math.radians(self.node_longitude_deg), math.radians(self.from_node_deg)
        path = OrbiterPath(orbit, inclination, (node, drift - turning), angle)
        return Passes(sky, sky.frame, path, math.radians(self.least_elevation_deg))


@dataclass(frozen=True)
class OrbiterPath:
    """Of an orbiter in the axes of the body.

    Args:
        inclination: [rad]. node: its east longitude at the start and the rate of it [rad], [rad/s].
        angle: of the orbiter from the node at the start [rad].
    """

    orbit: CircularOrbit
    inclination: float
    node: tuple[float, float]
    angle: float

    def place(self, time: float) -> FloatArray:
        """`time` [s] after the start, shape (3,) [m]."""
        u, node = self.angle + self.orbit.rate * time, self.node[0] + self.node[1] * time
        along, across = math.cos(u), math.sin(u) * math.cos(self.inclination)
        east = math.cos(node) * along - math.sin(node) * across
        north = math.sin(node) * along + math.cos(node) * across
        return self.orbit.radius * np.array((east, north, math.sin(u) * math.sin(self.inclination)))


@dataclass(frozen=True)
class Passes:
    """See `OrbiterParams`; least elevation in radians."""

    sky: Sky
    frame: SiteFrame
    path: OrbiterPath
    least: float

    def at(self, time: int, x: float, y: float) -> tuple[bool, int]:
        """See Window."""
        begin, end = on_grid(time, NANOSECONDS)
        towards = self.frame.rotation.T @ (self.path.place(begin / NANOSECONDS) - self.frame.origin)
        return self.sky.is_over_horizon(towards, x, y, self.least), end
