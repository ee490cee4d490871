"""Force/torque sensor of six axes, between the last joint of an arm and its tool.

    measured = resolution * round((truth + bias + sigma n) / resolution), kept within the range of the axis

The bias is drawn once at the reset (1 sigma = `bias`); n is standard normal and new in every period. Order of the axes:
force x y z, moment x y z, in the frame of the sensor. Told is what the tool and all that it carries does to the arm: a
tool that hangs pulls down, one that stands on the ground pushes up. A reading at the end of the range is saturated.

Cross-talk, drift and what an overload leaves are in `wrench_errors`; a sensor whose file names none of them has none.
Assumption: white noise at the rate of the reading.
"""

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream, quantise_within
from sojourn_physics.sensors.truth import require_numbers
from sojourn_physics.sensors.wrench_errors import (
    AXES,
    WrenchConditions,
    WrenchErrors,
    WrenchErrorsParams,
    initial_errors,
    seen,
)

AS_IT_WAS_ZEROED = WrenchConditions()


class AxesParams(Params):
    """Three axes alike: of force [N] or of moment [N m]."""

    resolution: float = Field(gt=0.0, le=1e3, description="step of the reading [N] or [N m]")
    noise: float = Field(ge=0.0, le=1e3, description="standard deviation of the noise [N] or [N m]")
    bias: float = Field(ge=0.0, le=1e3, description="standard deviation of the bias of an axis [N] or [N m]")
    largest: float = Field(gt=0.0, le=1e6, description="end of the range, both ways [N] or [N m]")


class WrenchSensorParams(Params):
    """The sensor of a machine's wrist; where it sits is in the machine's file."""

    force: AxesParams = Field(description="the three axes of force [N]")
    moment: AxesParams = Field(description="the three axes of moment [N m]")
    errors: WrenchErrorsParams | None = Field(default=None, description="what else is wrong with it; none: nothing")


@dataclass(frozen=True, eq=False, slots=True)
class WrenchSensorState:
    """Bias of the run, columns of the axes (6,) and the random stream."""

    bias: FloatArray
    noise: FloatArray
    resolution: FloatArray
    smallest: FloatArray
    largest: FloatArray
    stream: NoiseStream
    errors: WrenchErrors | None = None
    """None: of a sensor without any."""
    tells_nothing_beyond: bool = False
    """Whether an axis that is beyond its range is NaN."""


def initial_state(params: WrenchSensorParams, seed: int, name: str = "wrist") -> WrenchSensorState:
    """Sensor at the start of a run, its bias drawn from the stream of `name`."""

    def axes(name: str) -> FloatArray:
        return np.repeat([getattr(params.force, name), getattr(params.moment, name)], AXES // 2).astype(np.float64)

    stream, row = draw(initial_stream(seed, name, AXES))
    largest = axes("largest")
    columns = row * axes("bias"), axes("noise"), axes("resolution"), -largest, largest
    if params.errors is None:
        return WrenchSensorState(*columns, stream)
    errors = initial_errors(params.errors, largest, seed, name)
    return WrenchSensorState(*columns, stream, errors, params.errors.beyond == "nan")


def step(
    state: WrenchSensorState, truth: FloatArray, now: WrenchConditions = AS_IT_WAS_ZEROED
) -> tuple[WrenchSensorState, FloatArray]:
    """Measure `truth`, (6,) [N], [N m]; returns the state and the reading, alike. Raises InvalidValueError."""
    require_numbers("truth wrist_wrench", truth, (AXES,))
    errors, shown = (None, truth) if state.errors is None else seen(state.errors, truth, now)
    stream, noise = draw(state.stream)
    reading = quantise_within(shown, state.bias, state.noise, noise, state.resolution, state.smallest, state.largest)
    if state.tells_nothing_beyond:
        reading[np.abs(shown + state.bias) > state.largest] = np.nan
    return replace(state, stream=stream, errors=errors), reading
