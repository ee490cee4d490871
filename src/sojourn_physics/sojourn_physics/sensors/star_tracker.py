"""Star tracker: the attitude of its link in map, from stars, the clock and the place of the site.

    measured = q (x) exp(m + (s_c n_x, s_c n_y, s_a n_z))

q the true attitude; a turn in the tracker's frame, whose z axis is the boresight: m the lasting error of mounting and
optics, drawn at the reset; n standard normal, new in every reading, across the boresight (s_c) and, worse by what the
field of view is small against a radian, about it (s_a) (Liebe 1995, IEEE Aerospace and Electronic Systems Magazine
10(6):10; Markley and Crassidis 2014, Fundamentals of Spacecraft Attitude Determination and Control, sec. 4.2).

It finds stars where

- it turns no faster than `slew_limit_deg_per_second`,
- the Sun, if any of its disc is seen, is farther from the boresight than `sun_exclusion_deg`,
- the boresight stands higher than `horizon_exclusion_deg` over the horizon below it, and
- the sky is dark: there is no air that scatters sunlight, or the Sun is lower than `TWILIGHT_DEG`.

Left out: bright ground and parts of the machine in the baffle, planets and moons in the field, aberration of light (20
arcsec at the Earth, which such instruments correct), clouds and dust at night.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.imu_kernels import turn
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream

TWILIGHT_DEG = 12.0
"""The sky over air is dark with the Sun so far under the horizontal [deg]: the end of nautical twilight on Earth, an
estimate elsewhere."""
THIN_AIR = 1e-3
"""Air thinner than this scatters too little to hide stars [kg/m^3]: an estimate, a thousandth of the Earth's."""


class StarTrackerParams(Params):
    """One star tracker; errors are one standard deviation each."""

    link: str = Field(min_length=1, description="link of the URDF that carries it, fixed to base_link; boresight z")
    cross_boresight_arcsec: float = Field(ge=0.0, le=3600.0, description="noise about x and y [arcsec]")
    about_boresight_arcsec: float = Field(ge=0.0, le=3600.0, description="noise about the boresight [arcsec]")
    misalignment_arcsec: float = Field(default=0.0, ge=0.0, le=3600.0, description="lasting error, each axis [arcsec]")
    sun_exclusion_deg: float = Field(ge=0.0, le=180.0, description="least angle from boresight to the Sun [deg]")
    horizon_exclusion_deg: float = Field(ge=0.0, le=90.0, description="least height over the horizon [deg]")
    slew_limit_deg_per_second: float = Field(
        gt=0.0, le=100.0, description="largest rate at which it finds stars [deg/s]"
    )


class StarTrackerView(NamedTuple):
    """What a tracker has before it."""

    orientation: FloatArray
    """Of the tracker in map, quaternion x y z w, shape (4,)."""
    rate: float
    """At which it turns [rad/s]."""
    to_sun: FloatArray
    """Unit vector in map, shape (3,)."""
    sun_seen: float
    """Part of the Sun's disc that is seen, 0 to 1."""
    horizon: float
    """Elevation of the horizon below the boresight [rad]; minus infinity where there is none."""
    scattering_air: bool
    """Whether the sky is bright by day."""


@dataclass(frozen=True, eq=False, slots=True)
class StarTrackerState:
    """Drawn misalignment and random stream."""

    misalignment: FloatArray
    """Rotation vector in the tracker's frame, shape (3,) [rad]."""
    stream: NoiseStream


def initial_state(params: StarTrackerParams, seed: int, name: str) -> StarTrackerState:
    """The lasting error is drawn from the stream of `name`."""
    stream, row = draw(initial_stream(seed, name, 3))
    return StarTrackerState(row * math.radians(params.misalignment_arcsec / 3600.0), stream)


def boresight(orientation: FloatArray) -> FloatArray:
    """In map, shape (3,): the z axis of a quaternion x y z w."""
    x, y, z, w = orientation.tolist()
    return np.array((2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)))


def finds_stars(params: StarTrackerParams, view: StarTrackerView) -> bool:
    """Whether it has an attitude; see the head of this module."""
    axis = boresight(view.orientation)
    elevation = math.asin(min(max(float(axis[2]), -1.0), 1.0))
    to_sun = math.acos(min(max(float(axis @ view.to_sun), -1.0), 1.0))
    sun_elevation = math.asin(min(max(float(view.to_sun[2]), -1.0), 1.0))
    return (
        view.rate <= math.radians(params.slew_limit_deg_per_second)
        and (view.sun_seen <= 0.0 or to_sun >= math.radians(params.sun_exclusion_deg))
        and elevation - view.horizon >= math.radians(params.horizon_exclusion_deg)
        and not (view.scattering_air and sun_elevation > -math.radians(TWILIGHT_DEG))
    )


def step(
    params: StarTrackerParams, state: StarTrackerState, view: StarTrackerView
) -> tuple[StarTrackerState, FloatArray | None]:
    """One reading: the state, and the measured quaternion x y z w, shape (4,); None where it finds no stars.

    Raises:
        InvalidValueError: an orientation or a direction of the Sun that is none.
    """
    for name, value, size in (("orientation", view.orientation, 4), ("direction of the Sun", view.to_sun, 3)):
        if value.shape != (size,) or not abs(float(value @ value) - 1.0) < 1e-6:
            raise InvalidValueError(f"{name} at the star tracker", value.tolist(), f"{size} numbers of length 1")
    stream, noise = draw(state.stream)  # in every reading, so that a bright sky shifts no later noise
    after = StarTrackerState(state.misalignment, stream)
    if not finds_stars(params, view):
        return after, None
    sigma = np.array((params.cross_boresight_arcsec,) * 2 + (params.about_boresight_arcsec,))
    error = state.misalignment + np.radians(sigma / 3600.0) * noise
    turned: FloatArray = turn(np.array(view.orientation), error[0], error[1], error[2])
    return after, turned / math.sqrt(float(turned @ turned))
