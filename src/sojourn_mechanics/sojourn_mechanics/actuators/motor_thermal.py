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
from typing import NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator
from scipy.linalg import expm

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import Params

REFERENCE = 298.15
"""Temperature of catalogue values [K]."""
COPPER = 0.0039
"""Growth of the resistance [1/K]."""


class MotorThermalParams(Params):
    """Thermal side of a motor."""

    winding_capacity: float = Field(gt=0.0, le=1e6, description="C_w [J/K]")
    housing_capacity: float = Field(gt=0.0, le=1e6, description="C_h [J/K]")
    winding_to_housing: float = Field(gt=0.0, le=1e4, description="R_wh [K/W]")
    housing_to_ambient: float = Field(gt=0.0, le=1e4, description="R_ha [K/W]; larger in vacuum")
    magnet_coefficient: float = Field(default=-0.0011, ge=-0.01, le=0.0, description="a_m [1/K]")
    derate_temperature: float = Field(gt=0.0, le=1000.0, description="T_derate of the winding [K]")
    largest_temperature: float = Field(gt=0.0, le=1000.0, description="T_max of the winding [K]")
    demagnetisation_cold: tuple[float, float] = Field(description="temperature of the magnets [K] and current [A]")
    demagnetisation_hot: tuple[float, float] = Field(description="temperature of the magnets [K] and current [A]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.derate_temperature < self.largest_temperature:
            raise ValueError(f"derate_temperature: allowed is less than {self.largest_temperature:g} K")
        if not self.demagnetisation_cold[0] < self.demagnetisation_hot[0]:
            raise ValueError("demagnetisation_cold: allowed is a lower temperature than demagnetisation_hot")
        if min(self.demagnetisation_cold[1], self.demagnetisation_hot[1]) < 0.0:
            raise ValueError("demagnetisation: allowed are currents of at least 0 A")
        return self


class MotorTemperatures(NamedTuple):
    """Of the winding and of the housing [K]."""

    winding: float
    housing: float


def step_temperatures(
    params: MotorThermalParams, state: MotorTemperatures, loss: float, ambient: float, dt: float
) -> MotorTemperatures:
    """After dt [s] of constant loss in the winding [W] in surroundings at `ambient` [K].

    Raises:
        InvalidValueError: a number that is not finite, or a negative step or temperature.
    """
    for name, value in (("loss", loss), ("ambient", ambient), ("dt", dt)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    through, out = 1.0 / params.winding_to_housing, 1.0 / params.housing_to_ambient
    matrix = np.array(
        [
            [-through / params.winding_capacity, through / params.winding_capacity],
            [through / params.housing_capacity, -(through + out) / params.housing_capacity],
        ]
    )
    rest = np.array(steady_temperatures(params, loss, ambient))
    now = rest + expm(matrix * dt) @ (np.array(state) - rest)
    return MotorTemperatures(float(now[0]), float(now[1]))


def steady_temperatures(params: MotorThermalParams, loss: float, ambient: float) -> MotorTemperatures:
    """Temperatures after a long time of constant loss [W]."""
    housing = ambient + loss * params.housing_to_ambient
    return MotorTemperatures(housing + loss * params.winding_to_housing, housing)


def warm_resistance(resistance: float, winding: float) -> float:
    """Resistance [ohm] of a winding with `resistance` at 25 degrees, at a temperature [K]."""
    return resistance * (1.0 + COPPER * (winding - REFERENCE))


def warm_torque_constant(params: MotorThermalParams, torque_constant: float, housing: float) -> float:
    """Torque constant [N m/A] at a temperature of the magnets [K]; at least 0."""
    return torque_constant * max(1.0 + params.magnet_coefficient * (housing - REFERENCE), 0.0)


def continuous_current(params: MotorThermalParams, resistance: float, ambient: float) -> float:
    """Current [A] that the winding stands for ever; `resistance` at 25 degrees [ohm]."""
    rise = params.largest_temperature - ambient
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
