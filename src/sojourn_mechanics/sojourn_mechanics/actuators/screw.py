"""From rotation to translation: power screws, ball screws, rack and pinion.

Screw with lead l on the mean diameter d, friction m on the flanks of half angle g (0 for a square thread), r =
atan(m/cos g), lead angle e = atan(l/(pi d)):

    raising  T = F (d/2) tan(e + r),  n_f = tan e / tan(e + r)
    lowering T = F (d/2) tan(r - e): more than 0 where it locks itself, e <= r;  n_b = tan(e - r)/tan e
(Shigley, Mechanical Engineering Design, ch. 8.) A ball screw is given by its efficiency, usually 0.9: r = atan of it
backwards. Rack: F = n T / r_p, v = w r_p.
Assumptions: collar friction left out, friction independent of speed. Range: e + r below a right angle.
"""

import math
from typing import NamedTuple

from sojourn_mechanics.errors import InvalidValueError


class Screw(NamedTuple):
    """Lead and mean diameter [m], friction coefficient [-], half angle of the flanks [rad]."""

    lead: float
    diameter: float
    friction: float
    flank: float = 0.0

    @property
    def lead_angle(self) -> float:
        """[rad]"""
        return math.atan(self.lead / (math.pi * self.diameter))

    @property
    def friction_angle(self) -> float:
        """[rad]"""
        return math.atan(self.friction / math.cos(self.flank))


def ball_screw(lead: float, diameter: float, efficiency: float = 0.9) -> Screw:
    """A screw with the friction that gives this efficiency when it raises."""
    if not 0.0 < efficiency <= 1.0:
        raise InvalidValueError("efficiency", efficiency, "more than 0, at most 1")
    angle = math.atan(lead / (math.pi * diameter))
    return Screw(lead, diameter, math.tan(math.atan(math.tan(angle) / efficiency) - angle))


def raising_torque(screw: Screw, force: float) -> float:
    """Torque [N m] that raises a force [N]."""
    _check(screw)
    return force * 0.5 * screw.diameter * math.tan(screw.lead_angle + screw.friction_angle)


def lowering_torque(screw: Screw, force: float) -> float:
    """Torque [N m] that lowers a force [N]; negative where the force turns the screw by itself and has to be held."""
    _check(screw)
    return force * 0.5 * screw.diameter * math.tan(screw.friction_angle - screw.lead_angle)


def raising_efficiency(screw: Screw) -> float:
    """Work on the force over work of the torque [-]."""
    _check(screw)
    return math.tan(screw.lead_angle) / math.tan(screw.lead_angle + screw.friction_angle)


def back_driving_efficiency(screw: Screw) -> float:
    """Work of the torque over work of the force that drives it [-]; 0 where the screw locks itself."""
    _check(screw)
    return max(math.tan(screw.lead_angle - screw.friction_angle) / math.tan(screw.lead_angle), 0.0)


def locks_itself(screw: Screw) -> bool:
    """Whether a force cannot turn the screw."""
    _check(screw)
    return screw.lead_angle <= screw.friction_angle


def rack_force(torque: float, pinion_radius: float, efficiency: float = 1.0) -> float:
    """Force on the rack [N] of a torque on its pinion [N m] of a radius [m]."""
    if not (pinion_radius > 0.0 and 0.0 < efficiency <= 1.0):
        raise InvalidValueError("pinion_radius, efficiency", (pinion_radius, efficiency), "more than 0; at most 1")
    return efficiency * torque / pinion_radius


def _check(screw: Screw) -> None:
    if not (screw.lead > 0.0 and screw.diameter > 0.0 and screw.friction >= 0.0 and 0.0 <= screw.flank < 1.5):
        raise InvalidValueError("screw", tuple(screw), "lead and diameter of more than 0, friction of at least 0")
    if screw.lead_angle + screw.friction_angle >= 0.5 * math.pi:
        raise InvalidValueError("screw", tuple(screw), "one with lead and friction angle below a right angle together")
