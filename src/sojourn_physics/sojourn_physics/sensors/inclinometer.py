"""Inclinometer of two axes: how far the x and the y axis of its link point above the horizontal, by what it weighs.

    raw_i = asin(((1 + S_i) f_i + m_i f_j) / g) + bias_i + k_i (T - T_0)
    y_i' = (raw_i - y_i) / tau,  read_i = q round((y_i + sigma n) / q) within the range

f the specific force in its frame and g gravity at the place, for which it is calibrated; S scale factor, m turn of its
axes in their plane (j the other axis, against its sign for i = y), bias and its growth k with the temperature, drawn at
the reset; n standard normal, new in every reading; tau of the damping. It cannot tell acceleration from weight:
sideways a the tilt is wrong by a / g. That is how pendulums held by a torquer and the micromechanical ones work (Singer
Instruments, TSD series; Titterton and Weston 2004, sec. 6.2 and 7.2).

Without gravity it reads nothing. Range: tilt well under 90 deg, where the arc sine has no slope.
"""

from dataclasses import dataclass
from math import asin, exp, isfinite, radians

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream, quantise_within
from sojourn_physics.sensors.truth import require_numbers


class InclinometerParams(Params):
    """One inclinometer; errors are one standard deviation each."""

    link: str = Field(min_length=1, description="link of the URDF that carries it, fixed to base_link")
    range_deg: float = Field(gt=0.0, le=85.0, description="largest tilt that it reads [deg]")
    resolution_deg: float = Field(gt=0.0, le=10.0, description="least bit [deg]")
    noise_deg: float = Field(ge=0.0, le=10.0, description="noise of a reading [deg]")
    bias_deg: float = Field(ge=0.0, le=10.0, description="reading at level [deg]")
    bias_deg_per_kelvin: float = Field(default=0.0, ge=0.0, le=1.0, description="what it changes by [deg/K]")
    scale_factor: float = Field(default=0.0, ge=0.0, le=0.5, description="error of the scale factor [1]")
    misalignment_deg: float = Field(default=0.0, ge=0.0, le=10.0, description="turn of an axis in their plane [deg]")
    time_constant: float = Field(default=0.0, ge=0.0, le=100.0, description="of the damping [s]")
    calibration_temperature: float = Field(
        default=293.15, gt=0.0, le=1000.0, description="where the bias is as said [K]"
    )


@dataclass(frozen=True, eq=False, slots=True)
class InclinometerState:
    """Drawn errors, random stream, and where the pendulums stand."""

    bias: FloatArray
    """Of both axes, shape (2,) [rad]."""
    bias_per_kelvin: FloatArray
    """Shape (2,) [rad/K]."""
    matrix: FloatArray
    """Of scale factors and misalignment, shape (2, 2)."""
    stream: NoiseStream
    gravity: float
    """[m/s^2]."""
    tilt: FloatArray | None
    """Where the pendulums stand, shape (2,) [rad]; None before the first reading."""


def initial_state(params: InclinometerParams, seed: int, gravity: float, name: str) -> InclinometerState:
    """Errors drawn from the stream of `name`.

    Raises:
        InvalidValueError: gravity [m/s^2] negative or not finite.
    """
    if not (isfinite(gravity) and gravity >= 0.0):
        raise InvalidValueError("gravity [m/s^2]", gravity, "a finite number, at least 0")
    _, row = draw(initial_stream(seed, f"{name}.reset", 8))
    turn = row[6:8] * radians(params.misalignment_deg)
    scale = 1.0 + row[4:6] * params.scale_factor
    return InclinometerState(
        bias=row[0:2] * radians(params.bias_deg),
        bias_per_kelvin=row[2:4] * radians(params.bias_deg_per_kelvin),
        matrix=np.array(((scale[0], turn[0]), (-turn[1], scale[1]))),
        stream=initial_stream(seed, name, 2),
        gravity=float(gravity),
        tilt=None,
    )


def step(
    params: InclinometerParams, state: InclinometerState, specific_force: FloatArray, dt: float, warmer: float = 0.0
) -> tuple[InclinometerState, FloatArray | None]:
    """One reading.

    Args:
        specific_force: true one in the frame of its link, upward at rest, shape (3,) [m/s^2]. dt: since the last [s].
        warmer: temperature over that of the calibration [K].

    Returns:
        the state, and what x and y point above the horizontal by, shape (2,) [rad]; None without gravity.

    Raises:
        InvalidValueError: a force of another shape, or a number that is not finite.
    """
    require_numbers("truth specific_force in the inclinometer", specific_force, (3,))
    if not isfinite(warmer):
        raise InvalidValueError("temperature of the inclinometer over its calibration [K]", warmer, "a finite number")
    stream, noise = draw(state.stream)
    if state.gravity == 0.0:
        return replace(state, stream=stream), None
    sines = (state.matrix @ specific_force[:2] / state.gravity).tolist()
    raw = np.array([asin(min(max(sine, -1.0), 1.0)) for sine in sines]) + state.bias + warmer * state.bias_per_kelvin
    tilt = raw
    if state.tilt is not None and params.time_constant > 0.0:
        tilt = raw + (state.tilt - raw) * exp(-dt / params.time_constant)
    one, most = np.ones(2), np.full(2, radians(params.range_deg))
    sigma, least_bit = radians(params.noise_deg) * one, radians(params.resolution_deg) * one
    reading: FloatArray = quantise_within(tilt, np.zeros(2), sigma, noise, least_bit, -most, most)
    return replace(state, stream=stream, tilt=tilt), reading
