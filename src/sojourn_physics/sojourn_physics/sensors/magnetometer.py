"""Magnetometer of three axes: the flux density about it, in the axes of its link, with the machine's own.

    reading = q round((S B + h + sigma n) / q) within the range,      S = 1 + E

B the field there; E what iron that is magnetised by B makes of it, and errors of scale and axes (soft iron): nine
numbers, each drawn once; h what the machine's magnets and currents add to it, which stays (hard iron), drawn once; n
standard normal, new in every reading. What is left of E and h after a calibration has the same form, so that a
calibrated instrument has smaller ones (Gebre-Egziabher et al. 2006, J. Aerospace Engineering 19(2):87; Vasconcelos et
al. 2011, IEEE Trans. Aerospace and Electronic Systems 47(2):1293).

Left out: what changes with temperature and with the currents of motors; fields that differ over the machine.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream, quantise_within
from sojourn_physics.sensors.truth import require_numbers


class MagnetometerParams(Params):
    """One magnetometer; errors are one standard deviation each."""

    link: str = Field(min_length=1, description="link of the URDF that carries it, fixed to base_link")
    range: float = Field(gt=0.0, le=10.0, description="largest flux density of an axis that it reads [T]")
    resolution: float = Field(gt=0.0, le=1e-3, description="least bit [T]")
    noise: float = Field(ge=0.0, le=1e-3, description="noise of a reading [T]")
    hard_iron: float = Field(default=0.0, ge=0.0, le=1e-2, description="what the machine adds along an axis [T]")
    soft_iron: float = Field(
        default=0.0, ge=0.0, le=0.5, description="by which each element of the matrix of scales and axes is off [-]"
    )


@dataclass(frozen=True, eq=False, slots=True)
class MagnetometerState:
    """Drawn errors and random stream."""

    matrix: FloatArray
    """S, shape (3, 3) [-]."""
    hard_iron: FloatArray
    """Shape (3,) [T]."""
    stream: NoiseStream


def initial_state(params: MagnetometerParams, seed: int, name: str) -> MagnetometerState:
    """Errors drawn from the stream of `name`."""
    _, row = draw(initial_stream(seed, f"{name}.reset", 12))
    matrix = np.eye(3) + params.soft_iron * row[3:].reshape(3, 3)
    return MagnetometerState(matrix, params.hard_iron * row[:3], initial_stream(seed, name, 3))


def step(
    params: MagnetometerParams, state: MagnetometerState, field: FloatArray
) -> tuple[MagnetometerState, FloatArray]:
    """One reading: the state after it, and the flux density that it tells, shape (3,) [T].

    Args:
        field: true one in the axes of its link, shape (3,) [T].

    Raises:
        InvalidValueError: a field of another shape, or a number that is not finite.
    """
    require_numbers("truth field in the magnetometer", field, (3,))
    stream, noise = draw(state.stream)
    one, most = np.ones(3), np.full(3, params.range)
    reading = quantise_within(
        state.matrix @ field, state.hard_iron, params.noise * one, noise, params.resolution * one, -most, most
    )
    return replace(state, stream=stream), reading


def deviation(params: MagnetometerParams, reading: FloatArray) -> float:
    """Standard deviation of an axis of a reading of such an instrument, shape (3,) [T]: of all its errors."""
    soft = params.soft_iron * float(np.linalg.norm(reading))
    return sqrt(params.noise**2 + params.resolution**2 / 12.0 + params.hard_iron**2 + soft**2)
