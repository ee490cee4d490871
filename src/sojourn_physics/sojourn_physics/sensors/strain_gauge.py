"""Torque of a joint by strain gauges in a Wheatstone bridge on a shaft that it twists.

    e   = e_r w/w_r                                 strain of the gauges at a torque w, e_r at the rated one
    c'  = (k e - c)/tau                             creep of gauge, glue and spring: exact for constant e
    a   = s (T - T_0)                               apparent strain of what the gauge's compensation leaves
    u   = bridge(g (1 + f) (e + c + a) + z)         voltage over supply; g the gauge factor, f and z drawn
    bridge(x): quarter x/(4 + 2 x); half x/2; full x   active arms: one, two neighbours of other sign, all four
    told = w_r 2 n F/(2^b u_r),  n = round(2^b (u + noise)/(2 F)), held to the converter's ends -F .. F

(Hoffmann 1989, An Introduction to Measurements using Strain Gages: bridge, apparent strain, creep.) u_r is the voltage
at the rated torque that its calibration has; a quarter bridge is not straight and is told as if it were. In a half or
full bridge whose arms are as warm as each other the apparent strain cancels out but for the part `matched`.

Assumptions: the spring is linear; a torque that changes within a period is its end's.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams
from sojourn_physics.sensors.truth import require_numbers

GAIN, ZERO, SLOPE = range(3)
"""Drawn for each sensor."""
DRAWN = 3


class StrainGaugeParams(Params):
    """A torque sensor in each of some joints, all alike."""

    rated_torque: float = Field(gt=0.0, le=1e6, description="at which the gauges have their rated strain [N m]")
    rated_strain: float = Field(default=1e-3, gt=0.0, le=0.02, description="of each gauge at that torque [1]")
    gauge_factor: float = Field(default=2.0, gt=0.0, le=200.0, description="relative resistance per strain [1]")
    bridge: Literal["quarter", "half", "full"] = Field(default="full", description="active arms: one, two, four")
    gain_error: float = Field(default=0.0, ge=0.0, le=0.2, description="standard deviation of the gain less 1 [1]")
    zero_error: float = Field(default=0.0, ge=0.0, le=1.0, description="standard deviation, of the rated torque [1]")
    apparent_strain: float = Field(
        default=0.0, ge=0.0, le=1e-3, description="standard deviation of what is left of compensation [1/K]"
    )
    matched: float = Field(default=0.1, ge=0.0, le=1.0, description="part of it that arms of a bridge differ by [1]")
    zero_temperature: float = Field(default=293.15, ge=50.0, le=500.0, description="at which there is none [K]")
    creep: float = Field(default=0.0, ge=0.0, le=0.05, description="after a long time, part of the strain [1]")
    creep_time: float = Field(default=300.0, gt=0.0, le=1e6, description="time constant of it [s]")
    noise: float = Field(default=0.0, ge=0.0, le=1e-2, description="standard deviation, of the bridge's supply [1]")
    full_scale: float = Field(
        default=4e-3, gt=0.0, le=0.5, description="end of the converter's range, of the supply [1]"
    )
    bits: int = Field(default=16, ge=8, le=24, description="counts of the converter, as a power of two [1]")

    @property
    def arms_alike(self) -> bool:
        """Whether a temperature that all gauges have cancels out."""
        return self.bridge != "quarter"


@dataclass(frozen=True, eq=False, slots=True)
class StrainGaugeState:
    """Drawn errors, (n, DRAWN), creep of each joint (n,) [1] and the random streams."""

    errors: FloatArray
    creep: FloatArray
    stream: NoiseStream


def output(params: StrainGaugeParams, relative: FloatArray) -> FloatArray:
    """Voltage of the bridge over its supply for relative changes of a gauge's resistance, (n,)."""
    if params.bridge == "quarter":
        return np.asarray(relative / (4.0 + 2.0 * relative))
    return relative / 2.0 if params.bridge == "half" else relative


def initial_state(params: StrainGaugeParams, seed: int, names: tuple[str, ...]) -> StrainGaugeState:
    """Sensors of joints, each drawn from the stream of its own name."""
    stream, row = draw(initial_streams(seed, dict.fromkeys(names, DRAWN)))
    return StrainGaugeState(row.reshape(-1, DRAWN), np.zeros(len(names)), stream)


def step(
    params: StrainGaugeParams, state: StrainGaugeState, torque: FloatArray, dt: float, temperature: float | None = None
) -> tuple[StrainGaugeState, FloatArray]:
    """Read torques, (n,) [N m], `dt` [s] after the last reading; returns the state and the readings, alike.

    Args:
        temperature: of the sensors [K]; None: that at which there is no apparent strain.

    Raises:
        InvalidValueError: torques of another shape or not finite, a negative or infinite time.
    """
    require_numbers("torque of the joints", torque, state.creep.shape)
    if not (math.isfinite(dt) and dt >= 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number, at least 0")
    strain = params.rated_strain * torque / params.rated_torque
    left = math.exp(-dt / params.creep_time)
    creep = params.creep * strain + (state.creep - params.creep * strain) * left
    off = 0.0 if temperature is None else temperature - params.zero_temperature
    seen_of_it = params.matched if params.arms_alike else 1.0
    apparent = params.apparent_strain * seen_of_it * off * state.errors[:, SLOPE]
    zero = params.zero_error * params.rated_strain * state.errors[:, ZERO]
    gain = params.gauge_factor * (1.0 + params.gain_error * state.errors[:, GAIN])
    stream, noise = draw(state.stream)
    volts = output(params, gain * (strain + creep + apparent + zero)) + params.noise * noise[::DRAWN]
    count, least = 2.0 * params.full_scale / 2.0**params.bits, -(2.0 ** (params.bits - 1))
    told = np.clip(np.floor(volts / count + 0.5), least, -least - 1.0) * count
    rated = output(params, np.array([params.gauge_factor * params.rated_strain]))[0]
    return StrainGaugeState(state.errors, creep, stream), params.rated_torque * told / rated
