"""Ways of the arm from where it is to one of several ends, checked along their whole length, and the plan made of one.

A way is a chain of straight joint-space moves that stop at each corner: the direct one first, then over each of
`via_poses`, then over the corners that the sampling planner finds. The last stretch, along the tool axis, may be slower
than the rest, so that what is met there is met softly.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np

from sojourn_flight.arm.collision import check_path, check_samples, refined
from sojourn_flight.arm.joint_path import JointPath, join
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.law_params import WayParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.motion_load import slower
from sojourn_flight.arm.param_groups import NamedPoseParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import Ground
from sojourn_flight.arm.sampling_planner import MARGINS, Detours, posture_of
from sojourn_flight.arm.trajectory import JointReference, TrajectoryError, at_rest, point_to_point, stop
from sojourn_machine.params import FloatArray

End: TypeAlias = tuple[FloatArray, FloatArray | None]
"""Joint positions (n,) of a target, and those by which it is approached, or None."""
_APPROACH_SAMPLES = 24


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion that may be carried out."""

    path: JointPath
    target: FloatArray  # joint positions at the end (n,) [rad or m]
    tip_target: FloatArray  # tip position at the end in base_link (3,) [m]
    retreat: FloatArray | None  # joint positions (n,) by which the target is left again
    retreat_time: float  # from this time on the path [s] the arm leaves by `retreat`
    leave: FloatArray | None  # joint positions (n,) that the path goes through first, to leave a target
    leave_time: float  # when it is there [s]
    note: str  # what the operator should know: retimed, by way of a named pose


@dataclass(frozen=True, slots=True, eq=False)
class Departure:
    """Where a motion begins."""

    reference: JointReference
    """On the present motion."""
    present: FloatArray
    """Target of the present goal (n,), for joints that a goal does not name."""
    retreat: FloatArray | None = None
    """Joint positions (n,) to go through first."""


def _ways(
    params: NamedPoseParams,
    model: ArmModel,
    target: FloatArray,
    approach: FloatArray | None,
    retreat: FloatArray | None,
) -> Iterator[tuple[list[FloatArray], str]]:
    """Corner postures of each way to a target, the target last, and a note for the operator."""
    tail = [target] if approach is None else [approach, target]
    heads: list[list[FloatArray]] = [[]] if retreat is None else [[retreat], []]
    for head in heads:
        yield [*head, *tail], ""
        for name in params.via_poses:
            yield (
                [*head, posture_of(params, model, name), *tail],
                f"by way of '{name}', the direct way collides",
            )


def any_way(
    params: WayParams,
    model: ArmModel,
    departure: Departure,
    choices: list[list[End]],
    detours: Detours,
) -> Plan:
    """A way to an end of the first of `choices` that has one: a direct one, or over a named pose, or else a detour."""
    reason = ""
    for ends in choices:
        try:
            return _first_way(params, model, departure, ends, detours.ground)
        except GoalRefusedError as error:
            reason = str(error)
    for ends in choices:
        plan = _detour(params, model, departure, ends, detours)
        if plan is not None:
            return plan
    raise GoalRefusedError(reason)


def _detour(
    params: WayParams,
    model: ArmModel,
    departure: Departure,
    ends: list[End],
    detours: Detours,
) -> Plan | None:
    """A way that the sampling planner finds, from where the arm comes to rest, or from where it has left its target."""
    reference, retreat = departure.reference, departure.retreat
    brake = stop(model, reference)
    rest = [] if brake.duration == 0.0 else [brake.sample(brake.duration)[0]]
    heads: list[list[FloatArray]] = [rest] if retreat is None else [[retreat], rest]
    tails = [_tail(params, model, end, detours.ground) for end in ends]
    for head, margin in product(heads, MARGINS):
        start = head[-1] if head else reference.position
        corners = detours.corners(start, [tail[0] for tail in tails], margin)
        if corners is None:
            continue
        tail = next(tail for tail in tails if np.array_equal(tail[0], corners[-1]))
        found = [*head, *corners, *tail[1:]]
        try:
            pieces = _pieces(params, model, reference, found, len(tail) > 1)
        except TrajectoryError:
            continue
        if check_path(params, model, join(pieces), detours.ground) is None:
            note = f"round what is in the way, over {len(found) - 1} corners"
            return _plan_of(model, pieces, found, tail[0] if len(tail) > 1 else None, retreat, note)
    return None


def _tail(params: WayParams, model: ArmModel, end: End, ground: Ground | None) -> list[FloatArray]:
    """Approach and target, or the target alone where the approach is not free."""
    target, approach = end
    if approach is None:
        return [target]
    line = refined(np.array([approach, target]), params.collision_step)
    free = check_samples(params, model, line, ground, allow_start=False) is None
    return [approach, target] if free else [target]


def _plan_of(
    model: ArmModel,
    pieces: list[JointPath],
    corners: list[FloatArray],
    approach: FloatArray | None,
    retreat: FloatArray | None,
    note: str,
) -> Plan:
    """The plan of pieces that go from corner to corner."""
    path, target = join(pieces), corners[-1]
    leaves = retreat is not None and corners[0] is retreat
    return Plan(
        path=path,
        target=target,
        tip_target=forward_kinematics(model, target).position,
        retreat=approach,
        retreat_time=path.duration - pieces[-1].duration,
        leave=retreat if leaves else None,
        leave_time=pieces[0].duration if leaves else 0.0,
        note=note,
    )


def _first_way(
    params: WayParams,
    model: ArmModel,
    departure: Departure,
    ends: list[End],
    ground: Ground | None,
) -> Plan:
    """The first way to one of `ends` that keeps limits and collides with nothing."""
    reason = ""
    candidates = [(end, way) for end in ends for way in _ways(params, model, *end, departure.retreat)]
    # Direct ways to every posture come before detours to any.
    candidates.sort(key=lambda candidate: bool(candidate[1][1]))
    for (_, approach), (corners, note) in candidates[: params.planning_attempts]:
        try:
            pieces = _pieces(params, model, departure.reference, corners, approach is not None)
        except TrajectoryError as error:
            reason = reason or str(error)
            continue
        collision = check_path(params, model, join(pieces), ground)
        if collision is None:
            return _plan_of(model, pieces, corners, approach, departure.retreat, note)
        reason = reason or collision.text()
    raise GoalRefusedError(reason)


def _pieces(
    params: WayParams, model: ArmModel, reference: JointReference, corners: list[FloatArray], approaches: bool
) -> list[JointPath]:
    """Motions from corner to corner; `approaches`: the last one runs at the approach's speed."""
    pieces = [point_to_point(model, reference, corners[0])]
    for here, there in pairwise(corners):
        pieces.append(point_to_point(model, at_rest(here), there))
    speed = params.contact.approach_speed
    if approaches and speed is not None and len(corners) > 1:
        last = pieces[-1]
        times = np.linspace(0.0, last.duration, _APPROACH_SAMPLES)
        tips = np.array([forward_kinematics(model, q).position for q in last.samples(times)])
        fastest = float(np.max(np.linalg.norm(np.diff(tips, axis=0), axis=1))) / max(times[1], 1e-9)
        if fastest > speed:
            start = at_rest(corners[-2])
            pieces[-1] = point_to_point(slower(model, speed / fastest, start), start, corners[-1])
    return pieces
