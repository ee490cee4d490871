"""Warm motors: two-body thermal model, what heat does to resistance and magnets, derating, demagnetisation.

    C_w T_w' = P - (T_w - T_h)/R_wh                        winding, P its losses
    C_h T_h' = (T_w - T_h)/R_wh - (T_h - T_a)/R_ha         housing with magnets, T_a surroundings
    R(T_w) = R_25 (1 + 0.0039 (T_w - 298.15)),   k(T_h) = k_25 (1 + a_m (T_h - 298.15))
        copper: IEC 60034-1; a_m of NdFeB -0.0011, of SmCo -0.0004, of ferrite -0.002 per kelvin
    continuous current at the largest winding temperature:  R(T_max) I^2 = (T_max - T_a)/(R_wh + R_ha)
    derating: the full current up to T_derate, then linearly to 0 at T_max
    demagnetisation: a current whose field takes the magnets past the knee; given at two temperatures, linear between
(maxon, Key information on motors; Hendershot and Miller 1994.) The step is exact for constant P: exponential of the
matrix.
Assumptions: two lumped bodies, no radiation term (put it into R_ha for the place), losses in the winding. Range: T_w up
to T_max.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from sojourn_machine.drives import MotorThermalParams
from sojourn_machine.errors import InvalidValueError

REFERENCE = 298.15
"""Temperature of catalogue values [K]."""
COPPER = 0.0039
"""Growth of the resistance [1/K]."""


class MotorTemperatures(NamedTuple):
    """Of the winding and of the housing [K]."""

    winding: float
    housing: float


def step_temperatures(
    params: MotorThermalParams, state: MotorTemperatures, loss: float, dt: float
) -> MotorTemperatures:
    """After dt [s] of constant loss in the winding [W].

    Raises:
        InvalidValueError: a number that is not finite, or a negative step or loss.
    """
    for name, value in (("loss", loss), ("dt", dt)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    rest = steady_temperatures(params, loss)
    (a, b), (c, d) = _left_after(params, dt)
    winding, housing = state.winding - rest.winding, state.housing - rest.housing
    return MotorTemperatures(rest.winding + a * winding + b * housing, rest.housing + c * winding + d * housing)


@lru_cache(maxsize=256)
def _left_after(params: MotorThermalParams, dt: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """What is left of the distance from the steady temperatures: exponential of the matrix."""
    through, out = 1.0 / params.winding_to_housing, 1.0 / params.housing_to_ambient
    matrix = np.array(
        [
            [-through / params.winding_capacity, through / params.winding_capacity],
            [through / params.housing_capacity, -(through + out) / params.housing_capacity],
        ]
    )
    (a, b), (c, d) = expm(matrix * dt).tolist()
    return (a, b), (c, d)


def steady_temperatures(params: MotorThermalParams, loss: float) -> MotorTemperatures:
    """Temperatures after a long time of constant loss [W]."""
    housing = params.surroundings + loss * params.housing_to_ambient
    return MotorTemperatures(housing + loss * params.winding_to_housing, housing)


def warm_resistance(resistance: float, winding: float) -> float:
    """Resistance [ohm] of a winding with `resistance` at 25 degrees, at a temperature [K]."""
    return resistance * (1.0 + COPPER * (winding - REFERENCE))


def warm_torque_constant(params: MotorThermalParams, torque_constant: float, housing: float) -> float:
    """Torque constant [N m/A] at a temperature of the magnets [K]; at least 0."""
    return torque_constant * max(1.0 + params.magnet_coefficient * (housing - REFERENCE), 0.0)


def continuous_current(params: MotorThermalParams, resistance: float) -> float:
    """Current [A] that the winding stands for ever; `resistance` at 25 degrees [ohm]."""
    rise = params.largest_temperature - params.surroundings
    if rise <= 0.0:
        return 0.0
    path = params.winding_to_housing + params.housing_to_ambient
    return math.sqrt(rise / path / warm_resistance(resistance, params.largest_temperature))


def demagnetisation_current(params: MotorThermalParams, housing: float) -> float:
    """Current [A] that the magnets stand at their temperature [K]; beyond the two temperatures it goes on linearly."""
    (cold, high), (hot, low) = params.demagnetisation_cold, params.demagnetisation_hot
    return max(high + (low - high) * (housing - cold) / (hot - cold), 0.0)


def allowed_current(params: MotorThermalParams, largest: float, state: MotorTemperatures) -> float:
    """Current [A] that controller and magnets allow now, `largest` being that of the cold motor [A]."""
    span = params.largest_temperature - params.derate_temperature
    derated = largest * min(max((params.largest_temperature - state.winding) / span, 0.0), 1.0)
    return min(derated, demagnetisation_current(params, state.housing))
