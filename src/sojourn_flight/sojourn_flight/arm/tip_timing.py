"""The timing of a path of the joints within limits of speed, acceleration and jerk, and of the speed of the tip.

On a path q(u):  qd = q' r,  qdd = q'' r^2 + q' dr/dt,  qddd = q''' r^3 + 3 q'' r dr/dt + q' d2r/dt2,  with r = du/dt.
So each place bounds r (the limit curve; Bobrow, Dubowsky & Gibson, IJRR 4(3), 1985), by shares of the limits that leave
something for changing it; between the bounds r rises and falls with a bounded dr/dt; a mean over the time in which an
acceleration builds up makes its changes soft. The motion is the cubic B-spline of the postures at every period of the
control, so that speed, acceleration and jerk are differences of these,
    v = (Q_k+1 - Q_k-1)/2h,   a = (Q_k+1 - 2 Q_k + Q_k-1)/h^2,   j = (Q_k+2 - 3 Q_k+1 + 3 Q_k - Q_k-1)/h^3
(de Boor, A Practical Guide to Splines, 1978), which are all looked at. Where a limit is passed r is bounded lower; what
is still too fast after `_ROUNDS` of this is run slower as a whole. Begins and ends at rest, without acceleration.

A spline leaves the chords of its points by h^2/6 times the acceleration: a hundredth of a millimetre.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.tip_following import FollowedPath
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

PERIOD = 0.02
"""h [s]."""
_CURVE_SHARE = 0.5
"""Share of an acceleration's limit for the curvature of the path; what is left is for changing the speed."""
_JERK_SHARE = 0.3
"""Share of a jerk's limit for the change of curvature."""
_PLACES = 8
"""Of the limit curve, per piece of the spline."""
_FEWEST_PLACES = 400
_ROUNDS = 12
_STRETCHES = 8
_EXACT = 1.0e-7
_LONGEST = 3600.0
"""A motion that takes longer is not made [s]."""


class TipTimingError(MachineError):
    """The path cannot be followed in a reasonable time; the message says where."""


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """Places u (k,) of a path, the largest rate du/dt there, and the largest d2u/dt2 [1/s], [1/s2]."""

    places: FloatArray
    rates: FloatArray
    changes: FloatArray


def jerk_limited(model: ArmModel, followed: FollowedPath, fastest: float) -> JointPath:
    """The motion along a path from rest to rest.

    Args:
        fastest: largest share of the tip's path in a second [1/s].

    Raises:
        TipTimingError: it would take more than an hour.
    """
    window = max(round(float(np.max(model.max_acceleration / model.max_jerk)) / PERIOD), 1)
    curve = _limit_curve(model, followed, fastest)
    for _ in range(_ROUNDS):
        places = _places_in_time(curve, window)
        excess = _excess(model, followed.joints.at(places)[0])
        if excess.max() <= 1.0 + _EXACT:
            break
        curve = _lower(curve, places, excess, window)
    for _ in range(_STRETCHES):
        worst = float(excess.max())
        if worst <= 1.0 + _EXACT:
            break
        count = len(places)
        periods = np.linspace(0.0, count - 1.0, math.ceil(1.001 * worst * count))
        places = np.asarray(CubicSpline(np.arange(count), places)(periods))
        excess = _excess(model, followed.joints.at(places)[0])
    return _b_spline(followed.joints.at(places)[0])


def _limit_curve(model: ArmModel, followed: FollowedPath, fastest: float) -> _Curve:
    path = followed.joints
    count = max(_PLACES * (len(path.spline.x) - 1), _FEWEST_PLACES)
    places = np.linspace(0.0, path.end, count + 1)
    _, slope, bend = path.at(places)
    twist = np.abs(path.spline(places, 3))
    slope, bend = np.maximum(np.abs(slope), 1e-9), np.maximum(np.abs(bend), 1e-9)
    share = np.maximum(followed.shares.at(places)[1][:, 0], 1e-9)
    rates = np.minimum.reduce(
        [
            np.min(model.max_velocity / slope, axis=1),
            np.min(np.sqrt(_CURVE_SHARE * model.max_acceleration / bend), axis=1),
            np.min(np.cbrt(_JERK_SHARE * model.max_jerk / np.maximum(twist, 1e-9)), axis=1),
            fastest / share,
        ]
    )
    changes = np.min((1.0 - _CURVE_SHARE) * model.max_acceleration / slope, axis=1)
    return _Curve(places, rates, changes)


def _places_in_time(curve: _Curve, window: int) -> FloatArray:
    """u at every period, at rest at both ends."""
    step = float(curve.places[1])
    squared = curve.rates**2
    squared[0] = squared[-1] = 0.0
    most = 2.0 * step * np.minimum(curve.changes[1:], curve.changes[:-1])
    for k in range(1, len(squared)):
        squared[k] = min(squared[k], squared[k - 1] + most[k - 1])
    for k in range(len(squared) - 2, -1, -1):
        squared[k] = min(squared[k], squared[k + 1] + most[k])
    rates = np.sqrt(squared)
    times = np.concatenate([[0.0], np.cumsum(2.0 * step / (rates[1:] + rates[:-1]))])
    if not times[-1] <= _LONGEST:
        slowest = float(curve.places[int(np.argmin(curve.rates[1:-1])) + 1] / curve.places[-1])
        raise TipTimingError(f"it would take {times[-1]:.0f} s, for the joints at {100.0 * slowest:.0f} % of the path")
    at = np.arange(np.ceil(times[-1] / PERIOD) + 1) * PERIOD
    i = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    gone, span = np.minimum(at, times[-1]) - times[i], times[i + 1] - times[i]
    places = curve.places[i] + gone * (rates[i] + 0.5 * gone * (rates[i + 1] - rates[i]) / span)
    rest = 2 * (window // 2) + 3
    padded = np.concatenate([np.zeros(rest), places, np.full(rest, curve.places[-1])])
    return np.asarray(uniform_filter1d(uniform_filter1d(padded, window), 3))


def _excess(model: ArmModel, postures: FloatArray) -> FloatArray:
    """How many times too fast the motion is at each period (k,): 1 where a limit is just reached."""
    speed = np.abs(np.diff(postures, axis=0)) / (PERIOD * model.max_velocity)
    acceleration = np.abs(np.diff(postures, 2, axis=0)) / (PERIOD**2 * model.max_acceleration)
    jerk = np.abs(np.diff(postures, 3, axis=0)) / (PERIOD**3 * model.max_jerk)
    worst = np.zeros(len(postures))
    worst[1:] = speed.max(axis=1)
    worst[1:-1] = np.maximum(worst[1:-1], np.sqrt(acceleration.max(axis=1)))
    worst[2:-1] = np.maximum(worst[2:-1], np.cbrt(jerk.max(axis=1)))
    return worst


def _lower(curve: _Curve, places: FloatArray, excess: FloatArray, window: int) -> _Curve:
    """Smaller bounds where the motion was too fast, and as long before and after as the mean reaches."""
    around = maximum_filter1d(np.maximum(excess, 1.0), 2 * window + 1)
    share = 1.0 / np.interp(curve.places, places, around)
    return replace(curve, rates=curve.rates * share, changes=curve.changes * share**2)


def _b_spline(postures: FloatArray) -> JointPath:
    """The cubic B-spline of postures (k, n) one period apart, from the first to the last."""
    points = np.vstack([postures[:1], postures[:1], postures, postures[-1:], postures[-1:]]).T
    before, here, there, beyond = points[:, :-3], points[:, 1:-2], points[:, 2:-1], points[:, 3:]
    count = here.shape[1]
    return JointPath(
        starts=np.tile(PERIOD * np.arange(count), (points.shape[0], 1)),
        position=(before + 4.0 * here + there) / 6.0,
        velocity=(there - before) / (2.0 * PERIOD),
        acceleration=(there - 2.0 * here + before) / PERIOD**2,
        jerk=(beyond - 3.0 * there + 3.0 * here - before) / PERIOD**3,
        duration=PERIOD * count,
    )
