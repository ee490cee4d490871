"""Friction of a geared joint: Coulomb, viscous and Stribeck.

    F(v) = [F_c + F_s exp(-(v/v_s)^2)] sign(v) + B v
F_c: sliding friction, which may differ forward and backward; F_s: what breakaway takes above it; v_s: Stribeck
velocity (Armstrong-Helouvry, Dupont & Canudas de Wit, Automatica 30(7), 1994, equation 3, with exponent 2).
sign(v) is smoothed to tanh(v/v_0), so that a simulation may be stepped through zero: for |v| > 3 v_0 it is within
0.5 %. At rest the model gives zero and not the force that holds: it is for motion.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SMOOTHING = 1.0e-3
"""v_0 [rad/s or m/s]."""


@dataclass(frozen=True, slots=True, eq=False)
class JointFriction:
    """Friction at n joints, arrays (n,)."""

    viscous: FloatArray  # [N m s/rad or N s/m]
    forward: FloatArray  # Coulomb for v > 0 [N m or N]
    backward: FloatArray  # Coulomb for v < 0, as a positive number [N m or N]
    breakaway: FloatArray  # above the Coulomb friction [N m or N]
    stribeck_velocity: FloatArray  # [rad/s or m/s]

    def __post_init__(self) -> None:
        for name in self.__slots__:
            values = getattr(self, name)
            smallest = 1e-12 if name == "stribeck_velocity" else 0.0
            if not (np.all(np.isfinite(values)) and np.all(values >= smallest)):
                raise InvalidValueError(f"friction {name}", values.tolist(), f"finite numbers of at least {smallest:g}")


def friction_effort(friction: JointFriction, velocities: FloatArray) -> FloatArray:
    """What the drives must give to overcome friction at joint `velocities` (n,): efforts (n,) [N m or N]."""
    coulomb = np.where(velocities >= 0.0, friction.forward, friction.backward)
    fading = friction.breakaway * np.exp(-((velocities / friction.stribeck_velocity) ** 2))
    return np.asarray((coulomb + fading) * np.tanh(velocities / SMOOTHING) + friction.viscous * velocities)
