"""Slip (skid) steering: wheels that cannot turn about the vertical, driven faster on one side than on the other.

A wheel at (x, y) with rim speed w over ground that moves under it at (u_x - r y, v + r x) slides by
s = (w - u_x + r y, -(v + r x)). The ground pulls along s with Coulomb friction that builds up over a slip speed:

    F = mu N s / sqrt(|s|^2 + v_s^2)        (v_s -> 0 is Coulomb's law)
    steady turn: sum F_x = 0, sum F_y = 0, sum (x F_y - y F_x) = 0      in (u, v, r)
    y_ICR of a side = (u - w_side)/r: where that side would roll freely; their distance over the track is > 1
    least moment for turning on the spot, v_s -> 0, narrow vehicle: sum mu N |x|

(Martinez et al. 2005, Int. J. Robotics Research 24(10):867; Wong and Chiang 2001, Proc. IMechE D 215:343; Genta and
Genta 2017, sec. 5.7.) Assumptions: plane ground, low speed (no centrifugal force), isotropic friction, given loads, no
soil pushed aside.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import root

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class SlipTurn(NamedTuple):
    """Steady slip-steered turn.

    forward, side [m/s], yaw_rate [rad/s]; forces (wheels, 2) [N]; power that the wheels put in [W]; power lost in
    sliding [W]; width_ratio: distance of the sides' free-rolling centres over the track [-].
    """

    forward: float
    side: float
    yaw_rate: float
    forces: FloatArray
    power: float
    sliding_power: float
    width_ratio: float


class SlipVehicle(NamedTuple):
    """Wheels: places (wheels, 2) [m] from the centre of mass, loads (wheels,) [N]; friction; speed v_s over which it
    builds up [m/s]."""

    places: FloatArray
    loads: FloatArray
    friction: float
    slip_speed: float = 0.01


def wheel_forces(vehicle: SlipVehicle, rims: FloatArray, motion: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Forces and sliding velocities, shapes (wheels, 2), for rim speeds (wheels,) [m/s] and motion (u, v, r)."""
    x, y = vehicle.places.T
    u, v, r = motion
    slide = np.column_stack([rims - u + r * y, -(v + r * x)])
    size = np.sqrt(np.sum(slide**2, axis=1) + vehicle.slip_speed**2)
    return np.asarray(vehicle.friction * vehicle.loads[:, None] * slide / size[:, None]), slide


def steady_turn(vehicle: SlipVehicle, left: float, right: float) -> SlipTurn:
    """The turn with these rim speeds of the left and right wheels [m/s].

    Raises:
        InvalidValueError: the balance was not found.
    """
    x, y = vehicle.places.T
    rims = np.where(y > 0.0, left, right)
    track = float(y.max() - y.min())
    weight = float(vehicle.loads.sum())
    scale = np.array([weight, weight, weight * max(track, float(np.ptp(x)))])

    def balance(motion: FloatArray) -> FloatArray:
        force, _ = wheel_forces(vehicle, rims, motion)
        moment = np.sum(x * force[:, 1] - y * force[:, 0])
        return np.asarray(np.array([force[:, 0].sum(), force[:, 1].sum(), moment]) / scale)

    mean = 0.5 * (left + right)
    for part in (0.6, 0.3, 0.9, 0.05):
        found = root(balance, [mean, 0.0, part * (right - left) / track], tol=1e-12)
        if found.success:
            break
    else:
        raise InvalidValueError("left, right", (left, right), "speeds with a steady turn")
    forces, slide = wheel_forces(vehicle, rims, found.x)
    u, v, r = (float(value) for value in found.x)
    ratio = abs((left - right) / r) / track if abs(r) > 1e-12 else np.inf
    return SlipTurn(u, v, r, forces, float(forces[:, 0] @ rims), float(np.sum(forces * slide)), float(ratio))


def spin_moment(vehicle: SlipVehicle) -> float:
    """Moment [N m] that sliding wheels resist with when the vehicle is turned about its centre of mass, rims at
    rest.
    """
    return float(np.sum(vehicle.friction * vehicle.loads * np.hypot(*vehicle.places.T)))
