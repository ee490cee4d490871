"""Heading from a sun sensor: one update of the odometry's filter for each sighting of the Sun.

The measured direction u of the Sun in base_link, levelled with roll and pitch of the IMU, l = Ry(pitch) Rx(roll) u, has
an azimuth about the vertical; so has the direction s that the ephemeris gives in odom. Their difference is the heading:

    z = atan2(s_y, s_x) - atan2(l_y, l_x),       v = wrap(z - yaw)

A mounting that is off by a small rotation m of base_link, and a levelling that is off by l about its x and y axes, give
with M = Ry Rx (m + l) in the levelled frame

    v = e_yaw - M_z + (l_z / r^2) (M_x l_x + M_y l_y) + n,    r^2 = l_x^2 + l_y^2,    var n = noise^2 / r^2

m stays while the rover drives. The levelling does not: an attitude filter that takes the time T to follow its
accelerometers, whose biases tilt "up" by b about the axes of base_link, keeps its error fixed to the ground while
the rover turns, and goes back to b in T. In axes that turn by t within the time dt,

    d = l - b,    d' = k (R(-t) (d + b) - b) + w,    k = exp(-dt / T),    var w = levelling^2 (1 - k^2)

with w for all else that levelling does wrong: speeding up and stopping, noise. So m (three numbers), b and d (two each)
belong to the state: the covariance is that of the odometry's errors [x, y, yaw, slip, side slip, gyro bias] and of
[m, b, d]. Each sighting is a Kalman update of them all, in Joseph's form: it turns the heading, moves the position by
what it was correlated with the heading, corrects the gyro's bias, and learns m from a start whose heading is known. A
filter without m would take a hundred sightings for independent ones.

A sighting is refused if its elevation or its heading is off by more than `gate` standard deviations (Bar-Shalom,
Li and Kirubarajan 2001, Estimation with Applications to Tracking and Navigation, sec. 5.4: NIS gate), or if the Sun
stands too high to tell a heading; the state is then left as it was.

Sources: Trebi-Ollennu et al. 2001, "Design and analysis of a sun sensor for planetary rover absolute heading
detection", IEEE Trans. Robotics and Automation 17:939; Ali et al. 2005, "Attitude and position estimation on the Mars
Exploration Rovers", IEEE SMC; Mahony, Hamel and Pflimlin 2008, IEEE Trans. Automatic Control 53:1203, eq. 32 (the
attitude filter, linear in small errors); Gelb 1974, Applied Optimal Estimation, sec. 3.6 and 4.2 (Gauss-Markov states).
Assumptions: small errors; the ephemeris and the clock are exact; the rover turns about the vertical.
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.odometry import MOUNTING, OdometryState, corrected, wrap_angle
from sojourn_flight.odometry.odometry_kernels import update_all
from sojourn_flight.odometry.odometry_params import HeadingFixParams
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class SunSighting:
    """One reading of the sun sensor. Arrays have shape (3,)."""

    in_base: FloatArray
    """Measured unit vector to the Sun in base_link; zeros where no Sun is seen."""
    in_odom: FloatArray
    """Where the ephemeris has it: unit vector in odom."""


@dataclass(frozen=True, slots=True)
class HeadingFixState:
    """What became of the sightings."""

    fixes: int = 0
    """Sightings that were used."""
    rejected: int = 0
    """Sightings that did not fit."""
    text: str = "no sighting yet"
    """What became of the last one, in words."""
    innovation: float = 0.0
    """Heading of the Sun less that of the odometry, at the last sighting with a heading [rad]."""
    deviation: float = 0.0
    """The same in standard deviations."""
    since: float = 0.0
    """Time since the last sighting that was used [s]."""
    turned: float = 0.0
    """By how much the rover has turned since then [rad]."""


BIAS = slice(MOUNTING + 3, MOUNTING + 5)
WANDER = slice(MOUNTING + 5, MOUNTING + 7)
"""Where b and d are in the covariance."""


def mounting_variances(params: HeadingFixParams | None) -> tuple[float, ...]:
    """Variances of m, b and d before the first sighting [rad^2], of a rover that has stood; none without a sensor."""
    if params is None:
        return ()
    bias, wander = params.levelling_bias_sigma**2, params.levelling_sigma**2
    return (*[params.misalignment_sigma**2] * 3, bias, bias, wander, wander)


def turned_on(heading: HeadingFixState, yaw_rate: float, dt: float) -> HeadingFixState:
    """After a period of `dt` [s] in which the rover turned at `yaw_rate` [rad/s]."""
    return replace(heading, since=heading.since + dt, turned=heading.turned + yaw_rate * dt)


def levelled_on(params: HeadingFixParams, odometry: OdometryState, since: float, turned: float) -> OdometryState:
    """The odometry with its levelling error as it is after the time `since` [s] and a turn by `turned` [rad]."""
    kept = math.exp(-since / params.levelling_time)
    cosine, sine = math.cos(turned), math.sin(turned)
    back = np.array(((cosine, sine), (-sine, cosine)))
    change = np.eye(odometry.covariance.shape[0])
    change[WANDER, WANDER], change[WANDER, BIAS] = kept * back, kept * (back - np.eye(2))
    covariance = change @ odometry.covariance @ change.T
    covariance[WANDER, WANDER] += params.levelling_sigma**2 * (1.0 - kept * kept) * np.eye(2)
    errors = np.zeros(len(change))
    errors[MOUNTING : MOUNTING + 7] = odometry.mounting
    return replace(
        odometry, covariance=0.5 * (covariance + covariance.T), mounting=(change @ errors)[MOUNTING : MOUNTING + 7]
    )


def fix_heading(
    params: HeadingFixParams, odometry: OdometryState, heading: HeadingFixState, sighting: SunSighting
) -> tuple[OdometryState, HeadingFixState]:
    """Both states after a sighting. The covariance of `odometry` must hold the mounting, see `mounting_variances`."""
    level = rotation_of(odometry.roll, odometry.pitch)
    seen = level @ sighting.in_base
    length, expected = float(np.linalg.norm(seen)), sighting.in_odom
    if length < 0.5:
        return odometry, replace(heading, text="no Sun in view")
    across = math.hypot(seen[0], seen[1])
    if min(across, math.hypot(expected[0], expected[1])) < math.cos(params.max_elevation):
        return odometry, replace(heading, text="the Sun stands too high for a heading")

    off = math.asin(min(max(seen[2] / length, -1.0), 1.0)) - math.asin(min(max(expected[2], -1.0), 1.0))
    levelling = 2.0 * params.levelling_bias_sigma**2 + params.levelling_sigma**2
    allowed = math.sqrt(params.noise_sigma**2 + params.misalignment_sigma**2 + levelling)
    if abs(off) > params.gate * allowed:
        text = f"rejected: elevation off by {math.degrees(off):.1f} deg"
        return odometry, replace(heading, rejected=heading.rejected + 1, text=text)

    sun_heading = math.atan2(expected[1], expected[0]) - math.atan2(seen[1], seen[0])
    before = levelled_on(params, odometry, heading.since, heading.turned)
    row = np.zeros(before.covariance.shape[0])
    row[2] = 1.0
    high = seen[2] / across**2
    by_rotation = level.T @ np.array((high * seen[0], high * seen[1], -1.0))
    row[MOUNTING : MOUNTING + 7] = np.concatenate((by_rotation, by_rotation[:2], by_rotation[:2]))
    innovation = wrap_angle(sun_heading - before.yaw - float(row[MOUNTING : MOUNTING + 7] @ before.mounting))
    variance = float(row @ before.covariance @ row) + (params.noise_sigma / across) ** 2
    deviation = innovation / math.sqrt(variance)
    if abs(deviation) > params.gate:
        text = f"rejected: heading off by {math.degrees(innovation):.1f} deg, {abs(deviation):.1f} sigma"
        rejected = heading.rejected + 1
        return odometry, replace(heading, rejected=rejected, text=text, innovation=innovation, deviation=deviation)

    change, covariance = update_all(before.covariance, row, (params.noise_sigma / across) ** 2, innovation)
    state = HeadingFixState(heading.fixes + 1, heading.rejected, "heading fixed", innovation, deviation)
    return corrected(before, change, covariance), state
