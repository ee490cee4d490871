"""Distance between the arm and the rover, itself and the ground, along a whole path before it is moved.

Links: signed distances between primitive shapes (GJK/EPA; Gilbert, Johnson, Keerthi 1988; the coal library
through Pinocchio), for pairs whose enclosing spheres are near enough. Along a path only those pairs are
looked at again that could have come near since their last look: a point of a shape moves at most
sum_i reach_i |dq_i|  over the joints i that move the pair's shapes against each other, with reach_i a bound
of its distance from joint i in any posture; so a pair that was d apart needs no look until this sum has
grown to d minus the clearance (conservative advancement; Mirtich, 1996). The posture is stepped by at most
`collision_step` per joint.

Ground: a plane in base_link, and the depth of a primitive below it exact from its support function; or, where a camera
has seen the ground, its relief, and points on the surfaces of the shapes (relief.py).

A pair (or a link and the ground) that is nearer than the clearance at the start may not come nearer, but
may part.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio

from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.near_pairs import go_on
from sojourn_flight.arm.param_groups import ClearanceParams
from sojourn_flight.arm.relief import Ground, GroundRelief, go_on_over, plane_row
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

_PART = 1.0e-4  # [m] a pair that starts too near may come nearer by rounding only


@dataclass(frozen=True, slots=True)
class Collision:
    """Two links (or a link and 'ground') that come too near."""

    first: str
    second: str
    distance: float  # signed [m]
    clearance: float  # [m]
    progress: float  # where on the path, 0 to 1

    def text(self) -> str:
        """The pair, the distance and the clearance in words."""
        how = (
            f"{self.distance * 1e3:.1f} mm apart"
            if self.distance > 0.0
            else f"overlap by {-self.distance * 1e3:.1f} mm"
        )
        return (
            f"collision of {self.first} and {self.second}: {how} "
            f"(at least {self.clearance * 1e3:.1f} mm is kept) at {self.progress * 100.0:.0f} % of the path"
        )


def check_posture(
    params: ClearanceParams, model: ArmModel, positions: FloatArray, ground: Ground | None
) -> Collision | None:
    """The first pair nearer than its clearance at joint `positions` (n,), or None."""
    return check_samples(params, model, positions[None, :], ground, allow_start=False)


def check_path(params: ClearanceParams, model: ArmModel, path: JointPath, ground: Ground | None) -> Collision | None:
    """The first collision along `path`, or None."""
    return check_samples(params, model, path_samples(path, params.collision_step), ground, allow_start=True)


def path_samples(path: JointPath, step: float) -> FloatArray:
    """Positions (m, n) along the path, both ends included, no joint more than `step` between two."""
    fastest = max(float(np.max(path.extremes()[2])), 1e-6)
    count = math.ceil(path.duration * fastest / (0.1 * step)) + 2
    fine = path.samples(np.linspace(0.0, path.duration, count))
    travel = np.concatenate([[0.0], np.cumsum(np.max(np.abs(np.diff(fine, axis=0)), axis=1))])
    # A fine step is at most a tenth of `step`, so that rounding up to one keeps within it.
    wanted = np.arange(0.0, travel[-1], 0.9 * step)
    picked = np.searchsorted(travel, wanted)
    return np.ascontiguousarray(fine[np.union1d(picked, [0, count - 1])])


def refined(postures: FloatArray, step: float) -> FloatArray:
    """Postures (m, n) with others on straight lines between them, no joint more than `step` from one to the next."""
    rows = [postures[:1]]
    for here, there in pairwise(postures):
        count = max(1, math.ceil(float(np.max(np.abs(there - here))) / step))
        rows.append(here + (np.arange(1, count + 1) / count)[:, None] * (there - here))
    return np.vstack(rows)


def check_samples(
    params: ClearanceParams, model: ArmModel, samples: FloatArray, ground: Ground | None, allow_start: bool
) -> Collision | None:
    """The first collision at the postures `samples` (m, n), or None.

    Args:
        allow_start: what is too near at the first sample is taken as given: it must not come nearer.
    """
    if not isinstance(ground, GroundRelief):
        return _check_links(params, model, samples, ground, allow_start)
    found = _check_links(params, model, samples, None, allow_start)
    last = samples.shape[0] - 1
    free = samples if found is None else samples[: round(found.progress * last) + 1]
    return _check_relief(params, model, free, ground, allow_start, max(last, 1)) or found


def _check_relief(
    params: ClearanceParams, model: ArmModel, samples: FloatArray, relief: GroundRelief, allow_start: bool, last: int
) -> Collision | None:
    """The first of the postures at which a link comes too near to ground that was seen."""
    clearances = [(_ground_clearance(params, link), _seen_clearance(params, link)) for _, link in model.arm_shapes]
    clearance = np.array(clearances).reshape(-1, 2)
    surface, room = model.surface, np.empty(len(clearance))
    k, shape, height = go_on_over(
        model.chain, np.ascontiguousarray(samples, dtype=np.float64), surface.points, surface.shapes, surface.parents,
        clearance, room, relief.heights, relief.seen, relief.corner, relief.cell, plane_row(relief.plane), allow_start,
    )  # fmt: skip
    if k < 0:
        return None
    link = model.arm_shapes[shape][1]
    return Collision(link, "ground", height, _seen_clearance(params, link), k / last)


def _check_links(
    params: ClearanceParams, model: ArmModel, samples: FloatArray, ground: GroundPlane | None, allow_start: bool
) -> Collision | None:
    """As `check_samples`, over a plane."""
    count = len(model.pairs)
    slack = np.zeros(count)
    clearance = np.full(count, params.collision_clearance)
    ground_links = model.arm_shapes if ground is not None else ()
    ground_slack = np.zeros(len(ground_links))
    ground_clearance = np.array([_ground_clearance(params, link) for _, link in ground_links])
    last = max(samples.shape[0] - 1, 1)
    samples, near = np.ascontiguousarray(samples, dtype=np.float64), np.empty(count, dtype=np.int64)
    centres = model.shape_centres.copy()
    shape_reach = model.shape_reach[: len(ground_links)]
    k = 0
    while k >= 0:
        k, found = go_on(
            model.chain, samples, k, slack, ground_slack, model.pair_reach, shape_reach, model.pair_shapes,
            model.shape_radii, clearance, model.shape_parents, model.shape_places, centres, near,
        )  # fmt: skip
        if k < 0:
            break
        pinocchio.updateGeometryPlacements(
            model.pinocchio_model, model.data, model.geometry_model, model.geometry_data, samples[k]
        )
        for pair in near[:found].tolist():
            distance = _distance(model, pair)
            if k == 0 and allow_start:
                clearance[pair] = min(clearance[pair], distance - _PART)
            slack[pair] = distance - clearance[pair]
            if slack[pair] < 0.0:
                one, two = model.pairs[pair]
                return Collision(one, two, distance, params.collision_clearance, k / last)
        for item in np.flatnonzero(ground_slack <= 0.0).tolist():
            shape, link = ground_links[item]
            height = _height(model, shape, ground)
            if k == 0 and allow_start:
                ground_clearance[item] = min(ground_clearance[item], height - _PART)
            ground_slack[item] = height - ground_clearance[item]
            if ground_slack[item] < 0.0:
                return Collision(link, "ground", height, _ground_clearance(params, link), k / last)
        k += 1
    return None


def _ground_clearance(params: ClearanceParams, link: str) -> float:
    return -params.ground_contact_depth if link in params.ground_contact_links else params.ground_clearance


def _seen_clearance(params: ClearanceParams, link: str) -> float:
    return -params.seen_ground_depth if link in params.ground_contact_links else params.ground_clearance


def _distance(model: ArmModel, pair: int) -> float:
    """Signed distance of a collision pair at the placements last computed [m]."""
    pinocchio.computeDistance(model.geometry_model, model.geometry_data, pair)
    return float(model.geometry_data.distanceResults[pair].min_distance)


def _height(model: ArmModel, shape: int, ground: GroundPlane | None) -> float:
    """Lowest point of a shape above the ground plane [m]: centre height less the support function."""
    if ground is None:
        return math.inf
    normal = np.array(ground.normal)
    placement = model.geometry_data.oMg[shape]
    direction = placement.rotation.T @ normal
    geometry: Any = model.geometry_model.geometryObjects[shape].geometry
    kind = type(geometry).__name__
    if kind == "Box":
        support = float(np.abs(direction) @ geometry.halfSide)
    elif kind == "Sphere":
        support = float(geometry.radius)
    elif kind == "Capsule":
        support = float(geometry.radius + geometry.halfLength * abs(direction[2]))
    elif kind == "Cylinder":
        across = math.sqrt(max(1.0 - direction[2] ** 2, 0.0))
        support = float(geometry.radius * across + geometry.halfLength * abs(direction[2]))
    else:
        raise InvalidValueError("collision shape", kind, "Box, Sphere, Capsule or Cylinder")
    return float(normal @ placement.translation) - support - ground.height
