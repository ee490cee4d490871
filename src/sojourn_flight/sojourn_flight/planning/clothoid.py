"""Paths whose curvature grows linearly: clothoids (Euler spirals), and turns made of them and an arc.

    k(s) = k_0 + k' s,   heading h(s) = h_0 + k_0 s + k' s^2/2,   x + i y = int exp(i h) ds

With k' != 0, A = sqrt(pi/|k'|) and u = (k_0 + k' s)/(A |k'|) the integral is one of Fresnel's C, S (Abramowitz and
Stegun 1964, 7.3.1 and 7.3.2):  x + i y = A exp(i (h_0 - k_0^2/(2 k'))) [C(u) +- i S(u)], the sign that of k'.
A vehicle at constant speed V steers at the rate V k' l: clothoids are what a constant steering rate drives.
(Genta and Genta 2017, sec. 5.5; Scheuer and Fraichard 1997.) Range: any length; digits are lost where |k'| s^2 < 1e-9,
and the arc is taken there.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fresnel

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

STRAIGHT = 1e-9
"""|k'| s^2 [rad] below which a piece is an arc."""


class Pose(NamedTuple):
    """Place [m] and heading [rad]."""

    x: float
    y: float
    heading: float


class Piece(NamedTuple):
    """Part of a path: length [m], curvature at its start [1/m], growth of the curvature [1/m^2]."""

    length: float
    curvature: float
    sharpness: float


def along_clothoid(start: Pose, curvature: float, sharpness: float, s: ArrayLike) -> FloatArray:
    """Places and headings x, y, heading at distances s [m] of at least 0: shape (len(s), 3)."""
    distance = np.atleast_1d(np.asarray(s, dtype=np.float64))
    if np.any(~np.isfinite(distance)) or np.any(distance < 0.0):
        raise InvalidValueError("s", s, "finite numbers, at least 0 m")
    heading = start.heading + (curvature + 0.5 * sharpness * distance) * distance
    longest = float(distance.max(initial=0.0))
    if abs(sharpness) * longest**2 < STRAIGHT:
        place = _arc(start.heading, curvature + 0.5 * sharpness * distance, distance)
    else:
        scale = math.sqrt(math.pi / abs(sharpness))
        sign = math.copysign(1.0, sharpness)
        turn = np.exp(1j * (start.heading - curvature**2 / (2.0 * sharpness)))

        def primitive(k: FloatArray) -> FloatArray:
            sine, cosine = fresnel(k / (scale * sharpness))
            return np.asarray(cosine + 1j * sign * sine)

        ends = primitive(curvature + sharpness * distance) - primitive(np.array([curvature]))
        place = scale * turn * ends
    return np.column_stack([start.x + place.real, start.y + place.imag, heading])


def end_of(start: Pose, piece: Piece) -> Pose:
    """Pose at the end of a piece. The same as the last of `along_clothoid`, one by one and so many times faster."""
    length, curvature, sharpness = piece
    heading = start.heading + (curvature + 0.5 * sharpness * length) * length
    if abs(sharpness) * length**2 < STRAIGHT:
        half = 0.5 * (curvature + 0.5 * sharpness * length) * length
        sinc = math.sin(half) / half if half != 0.0 else 1.0
        place = length * sinc * cmath.exp(1j * (start.heading + half))
    else:
        scale = math.sqrt(math.pi / abs(sharpness))
        sign = math.copysign(1.0, sharpness)
        sine, cosine = fresnel((curvature + sharpness * length) / (scale * sharpness))
        first_sine, first_cosine = fresnel(curvature / (scale * sharpness))
        turn = cmath.exp(1j * (start.heading - curvature**2 / (2.0 * sharpness)))
        place = scale * turn * complex(cosine - first_cosine, sign * (sine - first_sine))
    return Pose(start.x + place.real, start.y + place.imag, heading)


def turn_pieces(angle: float, greatest_curvature: float, sharpness: float) -> tuple[Piece, ...]:
    """Clothoid in, arc, clothoid out that turn a heading by `angle` [rad] from straight to straight.

    Where the clothoids alone turn far enough there is no arc and the curvature stays below the greatest.

    Args:
        greatest_curvature: [1/m], sharpness: growth of the curvature [1/m^2], both more than 0.
    """
    if not (greatest_curvature > 0.0 and sharpness > 0.0):
        raise InvalidValueError("greatest_curvature, sharpness", (greatest_curvature, sharpness), "more than 0")
    sign, size = math.copysign(1.0, angle), abs(angle)
    curvature = min(greatest_curvature, math.sqrt(size * sharpness))
    ramp = curvature / sharpness
    arc = (size - curvature * ramp) / curvature if curvature > 0.0 else 0.0
    pieces = [Piece(ramp, 0.0, sign * sharpness)]
    if arc > 1e-12:
        pieces.append(Piece(arc, sign * curvature, 0.0))
    pieces.append(Piece(ramp, sign * curvature, -sign * sharpness))
    return tuple(pieces)


def sample_path(start: Pose, pieces: tuple[Piece, ...], spacing: float) -> FloatArray:
    """Points of a path: distance, x, y, heading, curvature; shape (n, 5), ends of the pieces always among them."""
    if not spacing > 0.0:
        raise InvalidValueError("spacing", spacing, "more than 0 m")
    rows, pose, before = [], start, 0.0
    for piece in pieces:
        s = np.linspace(0.0, piece.length, max(math.ceil(piece.length / spacing), 1) + 1)
        points = along_clothoid(pose, piece.curvature, piece.sharpness, s)
        rows.append(np.column_stack([before + s, points, piece.curvature + piece.sharpness * s]))
        pose, before = end_of(pose, piece), before + piece.length
    return np.concatenate(rows)


def _arc(heading: float, curvature: FloatArray, s: FloatArray) -> FloatArray:
    half = 0.5 * curvature * s
    return np.asarray(s * np.sinc(half / math.pi) * np.exp(1j * (heading + half)))
