"""Sun sensor: the direction to the Sun in the sensor's frame, where the Sun is seen and in the field of view.

    measured = unit(u + (m + sigma n) x u)

u the true direction in the frame of the sensor, whose z axis is the boresight; m a misalignment of the mounting, drawn
once at the reset, about each axis of 1 sigma = `misalignment_deg`; n standard normal and new in every reading, so that
the noise of the direction is `noise_deg` across the line of sight in both directions (Wertz 1978, Spacecraft Attitude
Determination and Control, sec. 6.1: digital sun sensors, field of view up to 128 deg, 0.01 to 0.5 deg).

No fix, a vector of zeros, where half of the Sun's disc is hidden (its centre is below the horizon, or something
has come before it) or it is farther from the boresight than `field_of_view_deg`. Assumptions: small angles; nothing of
the machine stands in the way; no albedo; half a disc is found where a whole one would be, 0.1 deg off at most.
"""

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream


class SunSensorParams(Params):
    """One sun sensor."""

    link: str = Field(min_length=1, description="link of the URDF that carries it, fixed to base_link; boresight z")
    field_of_view_deg: float = Field(gt=0.0, le=180.0, description="largest angle from the boresight [deg]")
    noise_deg: float = Field(ge=0.0, le=10.0, description="noise of the direction, on each axis across it [deg]")
    misalignment_deg: float = Field(ge=0.0, le=10.0, description="error of the mounting about each axis [deg]")


@dataclass(frozen=True, eq=False, slots=True)
class SunSensorState:
    """Drawn misalignment and random stream."""

    misalignment: FloatArray
    """Rotation vector in the sensor's frame, shape (3,) [rad]."""
    stream: NoiseStream


def initial_state(params: SunSensorParams, seed: int, name: str = "sun") -> SunSensorState:
    """The mounting's error is drawn from the stream of `name`."""
    stream, row = draw(initial_stream(seed, name, 3))
    return SunSensorState(row * math.radians(params.misalignment_deg), stream)


def step(
    params: SunSensorParams, state: SunSensorState, direction: FloatArray, visible: float
) -> tuple[SunSensorState, FloatArray]:
    """One reading.

    Args:
        direction: true unit vector to the Sun in the sensor's frame, shape (3,).
        visible: part of the Sun's disc that is seen from where the machine is, 0 to 1.

    Returns:
        the state and the measured unit vector, shape (3,); zeros for no fix.

    Raises:
        InvalidValueError: a direction that is no unit vector of three numbers.
    """
    if direction.shape != (3,) or not abs(float(direction @ direction) - 1.0) < 1e-6:
        raise InvalidValueError("direction of the Sun", direction.tolist(), "a unit vector of three numbers")
    stream, noise = draw(state.stream)  # in every reading, so that a hidden Sun shifts no later noise
    after = SunSensorState(state.misalignment, stream)
    if visible <= 0.5 or direction[2] < math.cos(math.radians(params.field_of_view_deg)):
        return after, np.zeros(3)
    turned = direction + np.cross(state.misalignment + math.radians(params.noise_deg) * noise, direction)
    return after, turned / math.sqrt(float(turned @ turned))
