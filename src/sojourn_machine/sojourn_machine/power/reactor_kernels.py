"""Kinetics of a reactor core that its own temperature governs, in compiled code.

    n     = sum(xi_k) / (1 - rho)                 prompt jump; rho in dollars, n: fission power
    xi_k' = lambda_k (f_k n - xi_k)               six groups of delayed neutrons, xi_k in watts
    C T'  = n - Q_e - G (T - T_0)

(Hetrick 1971, "Dynamics of Nuclear Reactors", ch. 1 and 3). The short-lived groups are what damps a reactor that
follows its load: with one group it would swing for hours. Groups of uranium 235 in fast fission: Keepin, Wimett and
Zeigler 1957, "Delayed neutrons from fissionable isotopes of uranium, plutonium, and thorium", Phys. Rev. 107:1044. Each
group goes exponentially to what the power of the step's start makes of it.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SHARES: FloatArray = np.array((0.038, 0.213, 0.188, 0.407, 0.128, 0.026))
"""f, of all delayed neutrons [1]."""
DECAYS: FloatArray = np.array((0.0127, 0.0317, 0.115, 0.311, 1.40, 3.87))
"""lambda [1/s]."""
LEAST = 1e-3
"""Fission of a core that is not critical, by its neutron source [W]."""


class Core(NamedTuple):
    """What does not change."""

    capacity: float
    """C [J/K]."""
    feedback: float
    """[dollar/K]"""
    leak: float
    """G [W/K]."""
    cold: float
    """T_0 [K]."""
    worth: float
    """Of the rod where it stops [dollar]."""
    rod_rate: float
    """While it starts [dollar/s]."""
    reactivity: float
    """Limit of the start [dollar]."""
    power: float
    """Likewise [W]."""


@njit(cache=True)
def core_kernel(
    core: Core, groups: FloatArray, temperature: float, rod: float, drawn: float, steps: tuple[int, float]
) -> tuple[float, float, float]:
    """Many short steps.

    Args:
        groups: xi, (6,) [W]; changed. temperature: [K]. rod: its worth [dollar]. drawn: Q_e [W].
        steps: how many, and their length [s].

    Returns:
        temperature [K], worth of the rod [dollar], energy of fission [J].
    """
    count, h = steps
    released = 0.0
    for _ in range(count):
        warm = core.feedback * (temperature - core.cold)
        prompt = 1.0 - min(rod + warm, 0.95)
        left, fresh = 0.0, 0.0
        for k in range(groups.shape[0]):
            kept = math.exp(-DECAYS[k] * h)
            left += groups[k] * kept
            fresh += SHARES[k] * (1.0 - kept)
        # mean of the power at the step's start and of what it comes to at its end
        power = max(0.5 * (groups.sum() / prompt + left / max(prompt - fresh, 0.01)), LEAST)
        if rod < core.worth:
            if power > core.power:
                rod = max(rod - core.rod_rate * h, 0.0)
            elif rod + warm < core.reactivity:
                rod = min(rod + core.rod_rate * h, core.worth)
        for k in range(groups.shape[0]):
            held = SHARES[k] * power
            groups[k] = held + (groups[k] - held) * math.exp(-DECAYS[k] * h)
        temperature += (power - drawn - core.leak * (temperature - core.cold)) * h / core.capacity
        released += power * h
    return temperature, rod, released
