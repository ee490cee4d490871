"""Static tip-over margin of a vehicle on uneven ground: how far it is from rolling over an edge of its support.

The contacts, seen along gravity, have a convex outline. Over each of its edges, from contact i to contact j (counter-
clockwise), the machine may tip. With the unit vector a of the edge, the centre of mass c and the force of gravity g,

    l = (1 - a a^T) (p_i - c)        shortest way from the centre of mass to the edge
    f = (1 - a a^T) g                part of gravity that can turn the machine about the edge
    margin of the edge = angle between f and l, positive while f passes inside the edge

and the margin of the machine is the least of its edges: it tips where the margin becomes zero. This is the force-angle
measure of Papadopoulos and Rey (1996, Proc. IEEE ICRA, p. 3111) for gravity alone and without its weighting by
the force. For a level rectangle of width 2 b with the mass at height h it is atan(b / h), and a slope across the edge
takes its angle away.

Assumptions: quasi-static; contacts are points that push and do not pull; the suspension is locked while the machine
tips, which for a rocker-bogie holds for the outline and not for a bogie that tips by itself.
Range: any contacts of which three span an area. The Mars Exploration Rovers were built to stand at 45 degrees in any
direction (Lindemann and Voorhees 2005, Proc. IEEE SMC, p. 450).
"""

from itertools import permutations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

BoolArray: TypeAlias = NDArray[np.bool_]

OUTLINE_TOLERANCE = 1e-9
"""A contact this near to the line of an edge is taken to be on it [m]."""


def tip_over_margin(
    contacts_in_world: FloatArray,
    in_contact: BoolArray,
    centre_of_mass_in_world: FloatArray,
    up_in_world: FloatArray | None = None,
) -> FloatArray:
    """Angle by which the line of gravity is inside the outline of the contacts, for many instants at once.

    Args:
        contacts_in_world: places of the contacts, shape (n, k, 3) [m]. Those not in contact may be NaN.
        in_contact: which of them carry, shape (n, k).
        centre_of_mass_in_world: shape (n, 3) [m].
        up_in_world: unit vector against gravity, shape (3,); z if left out.

    Returns:
        Margin, shape (n,) [rad]; negative where the line of gravity is outside; NaN where the contacts that carry
        span no area, and so no outline.

    Raises:
        InvalidValueError: shapes that do not fit, or a direction that is no unit vector.
    """
    contacts = np.asarray(contacts_in_world, dtype=np.float64)
    centre = np.asarray(centre_of_mass_in_world, dtype=np.float64)
    carries = np.asarray(in_contact, dtype=np.bool_)
    up = np.array([0.0, 0.0, 1.0]) if up_in_world is None else np.asarray(up_in_world, dtype=np.float64)
    if contacts.ndim != 3 or contacts.shape[2] != 3:
        raise InvalidValueError("contacts_in_world.shape", contacts.shape, "(n, k, 3)")
    if carries.shape != contacts.shape[:2]:
        raise InvalidValueError("in_contact.shape", carries.shape, f"{contacts.shape[:2]}")
    if centre.shape != (len(contacts), 3):
        raise InvalidValueError("centre_of_mass_in_world.shape", centre.shape, f"{(len(contacts), 3)}")
    if up.shape != (3,) or not np.isclose(np.linalg.norm(up), 1.0, rtol=0.0, atol=1e-9):
        raise InvalidValueError("up_in_world", up.tolist(), "a unit vector")

    carries = carries & np.isfinite(contacts).all(axis=2)
    places = np.where(carries[:, :, None], contacts, 0.0)
    margin = np.full(len(contacts), np.inf)
    for first, last in permutations(range(contacts.shape[1]), 2):
        is_edge = _is_edge_of_outline(places, carries, first, last, up)
        angle = _angle_over_edge(places[:, first], places[:, last], centre, up)
        margin = np.where(is_edge, np.minimum(margin, angle), margin)
    return np.where(np.isfinite(margin), margin, np.nan)


def _is_edge_of_outline(places: FloatArray, carries: BoolArray, first: int, last: int, up: FloatArray) -> BoolArray:
    """Whether both contacts carry, and all others that do are on the left of the line or on it, and one truly left.

    Shape (n,).
    """
    along = places[:, last] - places[:, first]
    length = np.linalg.norm(along, axis=1)
    offsets = np.cross(along[:, None, :], places - places[:, None, first]) @ up
    offsets /= np.maximum(length, OUTLINE_TOLERANCE)[:, None]
    none_right = (~carries | (offsets >= -OUTLINE_TOLERANCE)).all(axis=1)
    some_left = (carries & (offsets > OUTLINE_TOLERANCE)).any(axis=1)
    return np.asarray(carries[:, first] & carries[:, last] & (length > OUTLINE_TOLERANCE) & none_right & some_left)


def _angle_over_edge(first: FloatArray, last: FloatArray, centre: FloatArray, up: FloatArray) -> FloatArray:
    """Angle from gravity to the edge about the edge's axis, shape (n,) [rad]; positive while the machine stands."""
    along = last - first
    axis = along / np.maximum(np.linalg.norm(along, axis=1), OUTLINE_TOLERANCE)[:, None]
    to_edge = first - centre
    to_edge = to_edge - np.sum(to_edge * axis, axis=1)[:, None] * axis
    force = -up - np.sum(-up * axis, axis=1)[:, None] * axis
    sine = np.sum(np.cross(to_edge, force) * axis, axis=1)
    cosine = np.sum(force * to_edge, axis=1)
    return np.asarray(np.arctan2(sine, cosine))
