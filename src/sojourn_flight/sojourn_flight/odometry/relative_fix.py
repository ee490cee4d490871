"""The odometry's filter and the way from a key frame: one update for each match of a camera.

The pose of the key frame (x, y, yaw in odom) has been cloned into the state of the filter when the key frame was made,
with its correlations, and with a variance added in x and y: the error that the key frame has as a whole, and that all
matches with it share. A match that finds base_link at z in the key frame's axes is then, with
D = R(yaw_k) z and the errors e of the state,

    D - (x - x_k) = e_x - e_x,k + D_y e_yaw,k + n,    likewise in y with -D_x,     cov n = R information^-1 R^T

one Kalman update along each eigenvector of the information that tells something. One that has seen a turn t besides

    t - (yaw - yaw_k) = e_yaw - e_yaw,k + n. It moves the pose, and by the
cross-covariances slip, side slip, gyro bias and the key frame itself; nothing is counted twice but what the points of
two matches share.

Slip. What the torques say of it is off by an amount that changes with the ground: at each match the covariance of slip
and drift is widened by slip_walk^2 times the way since the last one.

Gate. A match that fits the ground but not the believed slip (the squared innovation over its covariance beyond gate^2)
is first taken for ground that slips otherwise: the covariance is widened by a slip and a drift of lost_slip on the way
since the last match, as a motor that has died or a soil that has changed makes them. It is used if it fits then, and
if the next one says so, too (`key_frames`): a single edge on even ground fits in more than one place. A way shorter
than LEAST_WAY says nothing of the ground: a machine that turns on the spot or starts may have been dragged by as much,
and then its place is widened, not its slip. Ground that has changed so on the way between two matches may change back
on the way to the next one: after such a match slip and drift are unknown by as much as it has changed them.

Sources: Roumeliotis & Burdick (2002), IEEE ICRA, p. 1788 (stochastic cloning); Bar-Shalom, Li & Kirubarajan (2001),
Estimation with Applications to Tracking and Navigation, sec. 5.4 (gate). Assumptions: small errors of heading; slip and
drift do not turn within the way since the last match; each camera has one key frame at a time.
"""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.odometry import SIDE_SLIP, SLIP, OdometryState, corrected, wrap_angle
from sojourn_flight.odometry.odometry_kernels import cloned, update_all, widened
from sojourn_flight.odometry.relative_fix_params import RelativeFixParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

LARGEST_SIGMA = 0.03
"""A direction in which a match is worse carries no information [m, rad]."""

LEAST_WAY = 0.08
"""Way since the last match from which on the ground may be said to slip otherwise [m]."""


class Seen(NamedTuple):
    """What a match has found of base_link in the axes of its key frame."""

    frame: int
    """Which of the odometry's key frames."""
    way: FloatArray
    """x, y [m] and, of a match that tells it, the turn [rad]; shape (2,) or (3,)."""
    information: FloatArray
    """Of it, shape (2, 2) or (3, 3) [1/m^2, 1/rad^2], with at least one eigenvalue that is `informative`."""


class Fix(NamedTuple):
    """What became of a match."""

    odometry: OdometryState | None
    """Corrected; None where the match does not fit."""
    off: float
    """Length of the innovation [m]."""
    deviation: float
    """The same in standard deviations, before any widening by lost_slip [-]."""
    widened: bool
    """It fits with another slip than was believed, or where the machine has been dragged."""


def informative(information: NDArray[Any]) -> NDArray[np.bool_]:
    """Which eigenvalues of an information matrix [1/m^2, 1/rad^2] are large enough to be used."""
    return np.asarray(information > LARGEST_SIGMA**-2)


def key_place(odometry: OdometryState, frame: int) -> int:
    """Where the x of a key frame is in the covariance; y and yaw are behind it.

    Raises:
        InvalidValueError: the odometry is not made for so many.
    """
    keys = odometry.keys
    if keys is None or frame >= len(keys):
        count = 0 if keys is None else len(keys)
        raise InvalidValueError("key_frames", count, f"initial_odometry(..., key_frames={frame + 1}) or more")
    return len(odometry.covariance) - keys.size + 3 * frame


def key_frame(odometry: OdometryState, frame: int) -> tuple[float, float, float]:
    """Pose of a key frame in odom: x, y [m], yaw [rad]. Raises as `key_place`."""
    key_place(odometry, frame)
    x, y, yaw = np.asarray(odometry.keys)[frame].tolist()
    return x, y, yaw


def with_key_frame(odometry: OdometryState, frame: int, sigma: float = 0.0) -> OdometryState:
    """The odometry with a key frame where it is, which has an error of `sigma` of its own [m]. Raises as
    `key_place`.
    """
    first = key_place(odometry, frame)
    keys = np.array(odometry.keys)
    keys[frame] = odometry.x, odometry.y, odometry.yaw
    order = np.arange(len(odometry.covariance))
    order = np.concatenate([np.delete(order, slice(first, first + 3)), order[first : first + 3]])
    covariance = np.empty_like(odometry.covariance)
    covariance[np.ix_(order, order)] = cloned(odometry.covariance[np.ix_(order, order)], sigma**2)
    return replace(odometry, keys=keys, covariance=covariance)


def fix_way(params: RelativeFixParams, odometry: OdometryState, seen: Seen, since: tuple[float, float]) -> Fix:
    """The odometry after a match.

    Args:
        since: way from the last match, in odom [m].

    Raises:
        InvalidValueError: as `key_place`.
    """
    key = key_frame(odometry, seen.frame)
    values, axes = np.linalg.eigh(seen.information)
    used, told = informative(values), len(values)
    to_odom = rotation_of(0.0, 0.0, key[2])[:told, :told]
    gone = to_odom @ seen.way
    size = len(odometry.covariance)
    place = key_place(odometry, seen.frame)
    rows = np.zeros((told, size))
    rows[:, :told] = np.eye(told)
    rows[:, place : place + told] = -np.eye(told)
    rows[0, place + 2], rows[1, place + 2] = gone[1], -gone[0]
    believed = np.array((odometry.x - key[0], odometry.y - key[1], wrap_angle(odometry.yaw - key[2])))
    along = (to_odom @ axes[:, used]).T
    rows, noise = along @ rows, 1.0 / values[used]
    innovation = along @ (gone - believed[:told])

    way = math.hypot(*since)
    changed = params.slip_walk * math.sqrt(way)
    covariance = widened(odometry.covariance, *since, changed)
    off, lost = float(np.linalg.norm((along.T @ innovation)[:2])), False
    deviation = _deviation(covariance, rows, innovation, noise)
    if deviation > params.gate:
        covariance, lost = _doubted(covariance, since, params.lost_slip), True
        if _deviation(covariance, rows, innovation, noise) > params.gate:
            return Fix(None, off, deviation, lost)
    change = np.zeros(size)
    for row, value, variance in zip(rows, innovation, noise, strict=True):
        more, covariance = update_all(covariance, row, float(variance), float(value - row @ change))
        change += more
    if lost and way >= LEAST_WAY:
        covariance[SLIP, SLIP] += change[SLIP] ** 2
        covariance[SIDE_SLIP, SIDE_SLIP] += change[SIDE_SLIP] ** 2
    return Fix(corrected(odometry, change, covariance), off, deviation, lost)


def _doubted(covariance: FloatArray, since: tuple[float, float], lost_slip: float) -> FloatArray:
    """The covariance, widened by what may have happened that nobody told of."""
    if math.hypot(*since) >= LEAST_WAY:
        return np.asarray(widened(covariance, *since, lost_slip))
    dragged = covariance.copy()
    dragged[0, 0] += (lost_slip * LEAST_WAY) ** 2
    dragged[1, 1] += (lost_slip * LEAST_WAY) ** 2
    return dragged


def _deviation(covariance: FloatArray, rows: FloatArray, innovation: FloatArray, noise: FloatArray) -> float:
    """Length of the innovation in its standard deviations."""
    spread = rows @ covariance @ rows.T + np.diag(noise)
    return math.sqrt(float(innovation @ np.linalg.solve(spread, innovation)))
