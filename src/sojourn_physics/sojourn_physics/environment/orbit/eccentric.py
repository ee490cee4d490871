"""An orbit on an ellipse: where a spacecraft is and how fast, and how long it is in the shadow.

    E - e sin E = n t,   n = sqrt(GM/a^3),   a = r_p / (1 - e)
    r = a (1 - e cos E),   tan(v/2) = sqrt((1 + e)/(1 - e)) tan(E/2),   speed^2 = GM (2/r - 1/a)

(Vallado 2013, Fundamentals of Astrodynamics and Applications, chapter 2.) Time counts from the pericentre, v is the
angle from there. The shadow is a cylinder, as of `circular`: it holds what is behind the body and nearer to the axis
than its radius. The Sun stands at an angle beta over the plane, and its image there at an angle from the pericentre.
Range: below the speed of escape; no force but that of a point.
"""

import math
from dataclasses import dataclass

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.sun.orbits import eccentric_anomaly

SHADOW_STEPS = 720
"""Of a turn, equal in time, that are looked at; the ends of the shadow are then found by halving."""
HALVINGS = 40


@dataclass(frozen=True, slots=True)
class EccentricOrbit:
    """Round a body of a gravitational parameter [m^3/s^2] and a radius [m].

    Raises:
        InvalidValueError: an orbit that does not clear the body, or is none.
    """

    gravitational_parameter: float
    body_radius: float
    pericentre: float
    """Least radius [m]."""
    eccentricity: float

    def __post_init__(self) -> None:
        if not self.gravitational_parameter > 0.0 or not math.isfinite(self.gravitational_parameter):
            raise InvalidValueError("gravitational parameter", self.gravitational_parameter, "more than 0")
        if not 0.0 <= self.eccentricity < 1.0:
            raise InvalidValueError("eccentricity", self.eccentricity, "0 to less than 1: at 1 it leaves for good")
        if not 0.0 < self.body_radius < self.pericentre or not math.isfinite(self.pericentre):
            allowed = f"more than {self.body_radius:g} m, the body's"
            raise InvalidValueError("radius of the pericentre", self.pericentre, allowed)

    @property
    def semi_major_axis(self) -> float:
        """[m]"""
        return self.pericentre / (1.0 - self.eccentricity)

    @property
    def apocentre(self) -> float:
        """Greatest radius [m]."""
        return self.semi_major_axis * (1.0 + self.eccentricity)

    @property
    def semi_latus_rectum(self) -> float:
        """[m]"""
        return self.pericentre * (1.0 + self.eccentricity)

    @property
    def rate(self) -> float:
        """Mean motion [rad/s]."""
        return math.sqrt(self.gravitational_parameter / self.semi_major_axis**3)

    @property
    def period(self) -> float:
        """[s]"""
        return 2.0 * math.pi / self.rate

    def speed(self, radius: float) -> float:
        """At a radius that the orbit has [m]: [m/s]."""
        return math.sqrt(self.gravitational_parameter * (2.0 / radius - 1.0 / self.semi_major_axis))

    def place(self, time: float) -> tuple[float, float]:
        """In the plane a time after the pericentre [s], the first axis towards it [m]."""
        anomaly, e = eccentric_anomaly(self.rate * time, self.eccentricity), self.eccentricity
        a = self.semi_major_axis
        return a * (math.cos(anomaly) - e), a * math.sqrt(1.0 - e * e) * math.sin(anomaly)

    def in_shadow(self, time: float, beta: float, sun: float) -> bool:
        """A time after the pericentre [s].

        Args:
            beta: of the Sun over the plane. sun: of its image in the plane, from the pericentre along the flight [rad].
        """
        x, y = self.place(time)
        towards = math.cos(beta) * (x * math.cos(sun) + y * math.sin(sun))
        return towards < 0.0 and x * x + y * y - towards * towards < self.body_radius**2

    def shadow(self, beta: float, sun: float) -> float:
        """Time of a turn in the shadow [s]; arguments as of `in_shadow`."""
        step, total = self.period / SHADOW_STEPS, 0.0
        before = self.in_shadow(0.0, beta, sun)
        for number in range(SHADOW_STEPS):
            dark = self.in_shadow((number + 1) * step, beta, sun)
            if dark == before:
                total += step * dark
            else:
                edge = self._edge(number * step, step, beta, sun)
                total += edge if before else step - edge
            before = dark
        return total

    def longest_shadow(self, beta: float) -> float:
        """Of a turn, wherever the pericentre is: with the apocentre behind the body [s]."""
        return self.shadow(beta, 0.0)

    def _edge(self, start: float, step: float, beta: float, sun: float) -> float:
        """When the shadow ends or begins within a step from a time on, after it [s]."""
        low, high, first = 0.0, step, self.in_shadow(start, beta, sun)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.in_shadow(start + middle, beta, sun) == first else (low, middle)
        return 0.5 * (low + high)
