"""The odometry's filter and the way from a key frame: one update for each match of the camera.

The pose of the key frame (x, y, yaw in odom) has been cloned into the state of the filter when the key frame was made,
with its correlations, and with the variance of reference_sigma added in x and y: the error that its surface has as a
whole, and that all matches with it share. A match that finds base_link at z in the key frame's axes is then, with
D = R(yaw_k) z and the errors e of the state,

    D - (x - x_k) = e_x - e_x,k + D_y e_yaw,k + n,    likewise in y with -D_x,     cov n = R information^-1 R^T

one Kalman update along each eigenvector of the information that tells something. It moves the pose, and by the
cross-covariances slip, side slip, gyro bias and the key frame itself; nothing is counted twice but what the points of
two matches share.

Slip. What the torques say of it is off by an amount that changes with the ground: at each match the covariance of slip
and drift is widened by slip_walk^2 times the way since the last one.

Gate. A match that fits the ground but not the believed slip (the squared innovation over its covariance beyond gate^2)
is first taken for ground that slips otherwise: the covariance is widened by a slip and a drift of lost_slip on the way
since the last match, as a motor that has died or a soil that has changed makes them. It is used if it fits then, and
if the next one says so, too (`key_frames`): a single edge on even ground fits in more than one place. A way shorter
than LEAST_WAY says nothing of the ground: a machine that turns on the spot or starts may have been dragged by as much,
and then its place is widened, not its slip.

Sources: Roumeliotis & Burdick (2002), IEEE ICRA, p. 1788 (stochastic cloning); Bar-Shalom, Li & Kirubarajan (2001),
Estimation with Applications to Tracking and Navigation, sec. 5.4 (gate). Assumptions: small errors of heading; slip and
drift do not turn within the way since the last match.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.odometry import OdometryState, corrected
from sojourn_flight.odometry.odometry_kernels import update_all, widened
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

LARGEST_SIGMA = 0.03
"""A direction in which a match is worse carries no information [m]."""

LEAST_WAY = 0.08
"""Way since the last match from which on the ground may be said to slip otherwise [m]."""


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
    """Which eigenvalues of an information matrix [1/m^2] are large enough to be used."""
    return np.asarray(information > LARGEST_SIGMA**-2)


def fix_way(
    params: TerrainMatchParams,
    odometry: OdometryState,
    way: FloatArray,
    information: FloatArray,
    since: tuple[float, float],
) -> Fix:
    """The odometry after a match.

    Args:
        way: of base_link from the key frame, in its axes, shape (2,) [m]. information: of it, shape (2, 2) [1/m^2],
            with at least one eigenvalue that is `informative`. since: way from the last match, in odom [m].

    Raises:
        InvalidValueError: the odometry is not made for key frames.
    """
    key = odometry.key
    if key is None:
        raise InvalidValueError("key", key, "the pose of a key frame: initial_odometry(..., key_frames=True)")
    values, axes = np.linalg.eigh(information)
    used = informative(values)
    to_odom = rotation_of(0.0, 0.0, float(key[2]))[:2, :2]
    gone = to_odom @ way
    size = len(odometry.covariance)
    rows = np.zeros((2, size))
    rows[0, 0] = rows[1, 1] = 1.0
    rows[0, size - 3] = rows[1, size - 2] = -1.0
    rows[0, size - 1], rows[1, size - 1] = gone[1], -gone[0]
    along = (to_odom @ axes[:, used]).T
    rows, noise = along @ rows, 1.0 / values[used]
    innovation = along @ (gone - np.array((odometry.x - key[0], odometry.y - key[1])))

    changed = params.slip_walk * math.sqrt(math.hypot(*since))
    covariance = widened(odometry.covariance, *since, changed)
    off, lost = float(np.linalg.norm(innovation)), False
    deviation = _deviation(covariance, rows, innovation, noise)
    if deviation > params.gate:
        covariance, lost = _doubted(covariance, since, params.lost_slip), True
        if _deviation(covariance, rows, innovation, noise) > params.gate:
            return Fix(None, off, deviation, lost)
    change = np.zeros(size)
    for row, value, variance in zip(rows, innovation, noise, strict=True):
        more, covariance = update_all(covariance, row, float(variance), float(value - row @ change))
        change += more
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
