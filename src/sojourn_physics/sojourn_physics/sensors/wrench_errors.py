"""What a sensor of six axes adds to a load beside bias and noise: cross-talk, drift, and what an overload leaves.

    seen = (1 + K) w + d + c (T - T_0) + h      w the load; an axis i has full scale F_i
    K_ij = x F_i/F_j N,  i != j                 drawn: one axis at full load shows x of full scale in another
    d    = d + s sqrt(dt) N                     random walk, s in units per square root of a second
    c                                           drawn: what an axis shows a kelvin away from T_0
    h_i  = p (|w_i| - o F_i) sign w_i           the largest so far: what has yielded keeps p of what was beyond o F_i

Cross-talk is what is left of a calibration by a matrix of 6 x 6, overload a load on one axis alone, as data sheets have
both (ATI Industrial Automation, F/T manual and data sheets). The yielded body hardens linearly: the same load a second
time leaves no more.

Assumptions: axes yield one by one; drift and cross-talk do not depend on the load.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream

AXES = 6
PER_ROOT_HOUR = 1.0 / 60.0
"""Of a random walk in units per square root of an hour, per square root of a second."""


class WrenchErrorsParams(Params):
    """Errors of all axes; left out: none."""

    crosstalk: float = Field(
        default=0.0,
        ge=0.0,
        le=0.5,
        description="standard deviation of an axis at full load of another, of its range [1]",
    )
    drift: float = Field(
        default=0.0, ge=0.0, le=1.0, description="random walk in an hour, standard deviation as a part of the range [1]"
    )
    temperature_drift: float = Field(
        default=0.0, ge=0.0, le=0.1, description="standard deviation of an axis' drift, of its range [1/K]"
    )
    zero_temperature: float = Field(default=293.15, ge=50.0, le=500.0, description="at which none of it is there [K]")
    overload: float = Field(default=5.0, ge=1.0, le=1e3, description="load that leaves no offset yet, of the range [1]")
    overload_offset: float = Field(default=0.0, ge=0.0, le=1.0, description="part of what was beyond that stays [1]")
    beyond: Literal["held", "nan"] = Field(
        default="held", description="what an axis beyond its range says: the end of the range, or nothing"
    )

    @property
    def is_none(self) -> bool:
        """Whether the sensor has none of them."""
        return not (self.crosstalk or self.drift or self.temperature_drift or self.overload_offset)


@dataclass(frozen=True, eq=False, slots=True)
class WrenchErrors:
    """Drawn errors of a run, and what has come of it: (6, 6), (6,) each."""

    params: WrenchErrorsParams
    full_scale: FloatArray
    coupling: FloatArray
    """1 + K."""
    per_kelvin: FloatArray
    walk: FloatArray
    yielded: FloatArray
    stream: NoiseStream


class WrenchConditions(NamedTuple):
    """Of a reading."""

    dt: float = 0.0
    """Since the last one [s]."""
    temperature: float | None = None
    """Of the sensor [K]; None: that at which there is no drift."""


def initial_errors(params: WrenchErrorsParams, full_scale: FloatArray, seed: int, name: str) -> WrenchErrors | None:
    """Errors of a run for axes with these ranges (6,), from the stream `NAME.errors`; None where there are none."""
    if params.is_none:
        return None
    stream, row = draw(initial_stream(seed, f"{name}.errors", AXES * AXES))
    matrix = params.crosstalk * row.reshape(AXES, AXES) * full_scale[:, None] / full_scale[None, :]
    np.fill_diagonal(matrix, 1.0)
    stream, row = draw(stream)
    per_kelvin = params.temperature_drift * full_scale * row[:AXES]
    return WrenchErrors(params, full_scale, matrix, per_kelvin, np.zeros(AXES), np.zeros(AXES), stream)


def seen(errors: WrenchErrors, load: FloatArray, now: WrenchConditions) -> tuple[WrenchErrors, FloatArray]:
    """The errors after a period under a load, (6,), and what the axes see of it, (6,), without bias and noise."""
    params = errors.params
    stream, noise = draw(errors.stream)
    step = params.drift * PER_ROOT_HOUR * math.sqrt(max(now.dt, 0.0)) * errors.full_scale
    walk = errors.walk + step * noise[:AXES]
    beyond = (
        params.overload_offset * np.sign(load) * np.maximum(np.abs(load) - params.overload * errors.full_scale, 0.0)
    )
    yielded = np.where(np.abs(beyond) > np.abs(errors.yielded), beyond, errors.yielded)
    off = 0.0 if now.temperature is None else now.temperature - params.zero_temperature
    shown = errors.coupling @ load + walk + errors.per_kelvin * off + yielded
    return replace(errors, walk=walk, yielded=yielded, stream=stream), shown
