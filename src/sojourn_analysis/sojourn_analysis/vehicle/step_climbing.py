"""Climbing a step, wheel by wheel, quasi-static: which friction it takes, and how high a step may be.

Seen from the side, both sides of the machine alike (so the differential does not turn and rocker and chassis are one
body). The machine is a body with wheels and, if it has one, a bogie with wheels hinged to it. While wheel k goes up the
vertical face, from the ground to the edge, and then around the edge, all others stand on flat ground before or behind
the step. At every position

    sum F = 0, sum M = 0, moment about the bogie's pivot = 0,      N_i >= 0,  |T_i| <= mu N_i,  |T_i| r_i <= T_max

in the normal and tangential forces N, T of all contacts asks for a point of a convex cone; motors may divide the
traction as they like. With the edges of each contact's friction cone as unknowns, and what is left of each motor's
torque, all unknowns are at least 0, and the answer is that of non-negative least squares (Lawson and Hanson 1974,
Solving least squares problems, chapter 23): there are such forces where nothing is left over. The step is climbed if
there is a solution at every position, for every wheel in turn.
Normals: horizontal on the face, from the edge to the wheel's centre at the edge. A wheel lower than its radius' worth
of step meets the edge at once. The underside of the body may not touch the edge. (Thueer, Krebs, Siegwart and Lamon
2007, J. Field Robotics 24:215, use the same statics.)
Assumptions: rigid step and wheels, no grousers hooking in, no inertia. Range: steps up to where a limit of the bogie is
reached or wheels would stand on the step's face two at a time.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import fsolve, nnls

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

POSITIONS = 16
"""Of each wheel on its way up."""
BALANCED = 1e-9
"""What may be left over of the weight, and of its moments about the pivot at 1 m, where forces balance it [-]."""


class SideWheel(NamedTuple):
    """Place of a wheel's centre on flat ground [m] (x forward, z up from the ground), radius [m], and whether on the
    bogie.
    """

    x: float
    z: float
    radius: float
    on_bogie: bool


@dataclass(frozen=True, slots=True)
class SideView:
    """One side of a machine with half of the chassis, standing on flat ground at z = 0.

    Args:
        mass, centre: of the body without the bogie [kg], (x, z) [m]. wheels: from front to rear.
        bogie_mass, bogie_centre, pivot: of the bogie with its wheels [kg], [m]; mass 0 for none.
        bogie_limit: largest angle of the bogie against the body [rad]. max_torque: of a wheel's motor [N m].
        belly: rear end, front end and height of the body's flat underside [m], which must clear the edge; None to leave
        it out.
    """

    mass: float
    centre: tuple[float, float]
    wheels: tuple[SideWheel, ...]
    bogie_mass: float = 0.0
    bogie_centre: tuple[float, float] = (0.0, 0.0)
    pivot: tuple[float, float] = (0.0, 0.0)
    bogie_limit: float = math.inf
    max_torque: float = math.inf
    belly: tuple[float, float, float] | None = None


class ClimbingPose(NamedTuple):
    """Place (x, z) [m] and pitch, nose up positive [rad], of the body's origin; angle of the bogie against it [rad]."""

    x: float
    z: float
    pitch: float
    bogie: float


def climbs(side: SideView, height: float, friction: float, gravity: float) -> bool:
    """Whether all wheels get up a step of a height [m] with a friction coefficient."""
    return failing_wheel(side, height, friction, gravity) is None


def failing_wheel(side: SideView, height: float, friction: float, gravity: float) -> int | None:
    """The first wheel that does not get up a step [m], counted from the front; None where all do.

    Raises:
        InvalidValueError: a height or friction that is not positive, or a number of wheels that does not fit the
        joints.
    """
    if not (height > 0.0 and friction > 0.0 and math.isfinite(height) and math.isfinite(friction)):
        raise InvalidValueError("height, friction", (height, friction), "finite numbers more than 0")
    hinged = sum(wheel.on_bogie for wheel in side.wheels)
    if (len(side.wheels), hinged) not in ((2, 0), (3, 2)):
        raise InvalidValueError("wheels", side.wheels, "two on the body, or one there and two on a bogie")
    for wheel in range(len(side.wheels)):
        ascent = _ascent(side, wheel, height)
        if not all(_holds(balance, side, friction, gravity) for balance in ascent.balances):
            return wheel
        if not ascent.whole:
            return wheel
    return None


def highest_step(side: SideView, friction: float, gravity: float, highest: float = 2.0) -> float:
    """Highest step [m] that is climbed, up to `highest`; 0 where none is."""
    low, high = 0.0, highest
    if climbs(side, high, friction, gravity):
        return high
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if climbs(side, middle, friction, gravity) else (low, middle)
    return low


def least_friction(side: SideView, height: float, gravity: float, highest: float = 4.0) -> float:
    """Least friction coefficient for a step [m]; infinite where `highest` is not enough."""
    if not climbs(side, height, highest, gravity):
        return math.inf
    low, high = 0.0, highest
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if climbs(side, height, middle, gravity) else (middle, high)
    return high


class _Balance(NamedTuple):
    """What the forces of a posture's contacts have to balance: rows F_x, F_z, moment and, with a bogie, its moment, all
    about the pivot and as parts of the weight.
    """

    normal: FloatArray
    """(rows, contacts): of a unit force along each contact's normal; lever arms in m."""
    tangential: FloatArray
    """(rows, contacts): along its tangent."""
    load: FloatArray
    """(rows,)"""
    radii: FloatArray
    """(contacts,): of the wheels [m]."""


class _Ascent(NamedTuple):
    """Balances on the way of a wheel up a step; whether it ends on top."""

    balances: tuple[_Balance, ...]
    whole: bool


@lru_cache(maxsize=128)
def _ascent(side: SideView, wheel: int, height: float) -> _Ascent:
    """As far as the joints let the wheel go, and the body clears the edge: geometry, whatever the friction."""
    balances: list[_Balance] = []
    guess: ClimbingPose | None = None
    for centre, normals in _way_up(side.wheels[wheel].radius, height):
        guess = _posture(side, wheel, centre, height, guess)
        if guess is None or abs(guess.bogie) > side.bogie_limit or _touches(side, guess, height):
            return _Ascent(tuple(balances), False)
        balances.append(_balance(side, wheel, guess, normals))
    return _Ascent(tuple(balances), True)


def _way_up(radius: float, height: float) -> list[tuple[tuple[float, float], list[tuple[float, float]]]]:
    """Centres of the climbing wheel, the face at x = 0, with the normals of its contacts."""
    way: list[tuple[tuple[float, float], list[tuple[float, float]]]] = []
    if height > radius:
        for z in np.linspace(radius, height, POSITIONS // 2):
            normals = [(-1.0, 0.0)]
            if z == radius:
                normals.append((0.0, 1.0))  # it still stands on the ground as well
            way.append(((-radius, float(z)), normals))
        start = 0.0
    else:
        start = math.asin((radius - height) / radius)
    for angle in np.linspace(start, 0.5 * math.pi - 1e-6, POSITIONS // 2):
        normal = (-math.cos(angle), math.sin(angle))
        normals = [normal]
        if angle == start and height <= radius:
            normals.append((0.0, 1.0))
        way.append(((radius * normal[0], height + radius * normal[1]), normals))
    return way


def _touches(side: SideView, posture: ClimbingPose, height: float) -> bool:
    """Whether the edge of the step is inside the body."""
    if side.belly is None:
        return False
    rear, front, under = side.belly
    edge = _turn(posture.pitch).T @ np.array([-posture.x, height - posture.z])
    return bool(rear < edge[0] < front and edge[1] > under)


def _place(posture: ClimbingPose, side: SideView, point: tuple[float, float], on_bogie: bool) -> FloatArray:
    """Where a point of the machine is, shape (2,) [m]."""
    local = np.array(point)
    if on_bogie:
        pivot = np.array(side.pivot)
        local = pivot + _turn(posture.bogie) @ (local - pivot)
    return np.asarray(np.array([posture.x, posture.z]) + _turn(posture.pitch) @ local)


def _turn(angle: float) -> FloatArray:
    """Turns x towards z: nose up."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def _posture(
    side: SideView, climbing: int, centre: tuple[float, float], height: float, guess: ClimbingPose | None
) -> ClimbingPose | None:
    """Posture with one wheel's centre at a point and the others on flat ground, on the step those ahead."""
    hinged = side.bogie_mass > 0.0

    def misses(unknown: FloatArray) -> list[float]:
        posture = ClimbingPose(unknown[0], unknown[1], unknown[2], unknown[3] if hinged else 0.0)
        found = []
        for index, wheel in enumerate(side.wheels):
            place = _place(posture, side, (wheel.x, wheel.z), wheel.on_bogie)
            if index == climbing:
                found += [place[0] - centre[0], place[1] - centre[1]]
            else:
                found.append(place[1] - wheel.radius - (height if index < climbing else 0.0))
        return found

    wheel = side.wheels[climbing]
    first = guess or ClimbingPose(centre[0] - wheel.x, centre[1] - wheel.z, 0.0, 0.0)
    solution, _, flag, _ = fsolve(misses, np.array(first[: 4 if hinged else 3]), full_output=True, xtol=1e-12)
    if flag != 1 or np.abs(misses(solution)).max() > 1e-8 or abs(solution[2]) > 1.2:
        return None
    return ClimbingPose(*(float(value) for value in solution), *(() if hinged else (0.0,)))


def _balance(side: SideView, climbing: int, posture: ClimbingPose, normals: list[tuple[float, float]]) -> _Balance:
    """Of a posture in which a wheel touches the step along normals, and the others the ground."""
    pivot = _place(posture, side, side.pivot, False)

    def wrench(point: FloatArray, force: FloatArray, on_bogie: bool) -> FloatArray:
        arm = point - pivot
        moment = arm[0] * force[1] - arm[1] * force[0]
        return np.array([force[0], force[1], moment, moment if on_bogie else 0.0])

    normal, tangential, radii = [], [], []
    for index, wheel in enumerate(side.wheels):
        centre = _place(posture, side, (wheel.x, wheel.z), wheel.on_bogie)
        for direction in normals if index == climbing else [(0.0, 1.0)]:
            n = np.array(direction)
            contact = centre - wheel.radius * n
            normal.append(wrench(contact, n, wheel.on_bogie))
            tangential.append(wrench(contact, np.array([n[1], -n[0]]), wheel.on_bogie))
            radii.append(wheel.radius)
    load = np.zeros(4)
    for mass, point, on_bogie in ((side.mass, side.centre, False), (side.bogie_mass, side.bogie_centre, True)):
        part = np.array([0.0, mass / (side.mass + side.bogie_mass)])
        load += wrench(_place(posture, side, point, on_bogie), part, on_bogie)
    rows = 4 if side.bogie_mass > 0.0 else 3
    return _Balance(np.array(normal).T[:rows], np.array(tangential).T[:rows], load[:rows], np.array(radii))


def _holds(balance: _Balance, side: SideView, friction: float, gravity: float) -> bool:
    """Whether forces within friction and torque balance the weight."""
    count = len(balance.radii)
    traction = friction * balance.tangential
    edges, load = np.hstack([balance.normal + traction, balance.normal - traction]), balance.load
    if math.isfinite(side.max_torque):
        most = side.max_torque / (balance.radii * (side.mass + side.bogie_mass) * gravity)
        one, left = friction * np.eye(count), np.eye(2 * count)
        both_ways = np.block([[one, -one], [-one, one]])
        edges = np.block([[edges, np.zeros((len(load), 2 * count))], [both_ways, left]])
        load = np.concatenate([load, most, most])
    _, left_over = nnls(edges, load, maxiter=100 * edges.shape[1])
    return bool(left_over <= BALANCED)
