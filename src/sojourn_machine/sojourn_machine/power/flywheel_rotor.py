"""The rotor of a flywheel: inertia, and the speed that its material stands.

Equations of a rotor of mass m and outer radius r, of density rho, at the speed w:

    ring (thin)    J = m r^2        stress = rho r^2 w^2                     E / m = 0.5 stress / rho
    disc (flat)    J = m r^2 / 2    stress = (3 + nu) / 8 rho r^2 w^2        E / m = 2 / (3 + nu) stress / rho

The stress is the largest: of the hoop of the ring, at the centre of the disc, which has no bore. The number in front of
stress / rho is the shape factor: 0.5, and 0.606 at a Poisson's ratio nu of 0.3.

Source: Genta 1985, "Kinetic Energy Storage" (shape factors); Timoshenko and Goodier 1970, "Theory of
Elasticity", art. 32 (rotating disc). Assumptions: plane stress, an isotropic disc; a ring whose hub carries nothing.
"""

from math import sqrt
from typing import Literal

from pydantic import Field

from sojourn_machine.params import Params


class RotorParams(Params):
    """One rotor."""

    shape: Literal["ring", "disc"] = Field(description="thin ring or flat disc without a bore")
    mass: float = Field(gt=0.0, le=1e6, description="that spins [kg]")
    radius: float = Field(gt=0.0, le=100.0, description="outer radius [m]")
    density: float = Field(gt=0.0, le=3e4, description="of the material [kg/m3]")
    strength: float = Field(gt=0.0, le=1e11, description="stress at which the material breaks, of a ring's hoop [Pa]")
    poisson_ratio: float = Field(default=0.3, ge=0.0, le=0.5, description="of a disc's material [1]")
    safety_factor: float = Field(ge=1.0, le=100.0, description="strength over the largest stress that is allowed [1]")

    @property
    def inertia(self) -> float:
        """About its axis [kg m2]."""
        solid = self.mass * self.radius**2
        return solid if self.shape == "ring" else 0.5 * solid

    def stress(self, speed: float) -> float:
        """The largest in the material at a speed [rad/s], in Pa."""
        hoop = self.density * (self.radius * speed) ** 2
        return hoop if self.shape == "ring" else 0.125 * (3.0 + self.poisson_ratio) * hoop

    @property
    def allowed_speed(self) -> float:
        """At which the stress is the strength over the safety factor [rad/s]."""
        return sqrt(self.strength / self.safety_factor / self.stress(1.0))
