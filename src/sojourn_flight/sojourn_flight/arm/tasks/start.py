"""From a request to a task under way: the directions and lines that it asks for, checked before anything moves.

Each of our tasks is begun by a function here; a request finds its own when it is asked to begin (`requests`).
"""

import math
from dataclasses import dataclass
from typing import TypeVar, get_args

import numpy as np

from sojourn_flight.arm.collision import check_samples, refined
from sojourn_flight.arm.goals import NamedGoal, PoseGoal
from sojourn_flight.arm.kinematics import forward_kinematics, nearby_solution
from sojourn_flight.arm.law_params import LineParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import Ground, depth_below
from sojourn_flight.arm.tasks.at_rest import AtRest
from sojourn_flight.arm.tasks.dig import DigTask
from sojourn_flight.arm.tasks.drill import DrillTask
from sojourn_flight.arm.tasks.dump import DumpTask
from sojourn_flight.arm.tasks.go import Go
from sojourn_flight.arm.tasks.guarded_move import GuardedMoveTask
from sojourn_flight.arm.tasks.hold_force import HoldForceTask
from sojourn_flight.arm.tasks.pick import PickTask, ReleaseTask, grasp_needed
from sojourn_flight.arm.tasks.requests import (
    Dig,
    Drill,
    Dump,
    GuardedMove,
    HoldForce,
    Pick,
    Place,
    Release,
    Stow,
    Tare,
    TaskRequest,
    Unfold,
    Weigh,
)
from sojourn_flight.arm.tasks.tare import TareTask
from sojourn_flight.arm.tasks.task import Task
from sojourn_flight.arm.tasks.weigh import TURN, WeighTask
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import DrillToolParams, GripperToolParams, ScoopToolParams, ToolParams

Tool = TypeVar("Tool", bound=ToolParams)
_STEP = 0.01
"""Distance of the places of a line that are looked at [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Beginning:
    """What a task begins with."""

    params: ArmParams
    model: ArmModel
    posture: FloatArray
    """Joint positions (n,) in which the arm rests, or will if it is stopped now [rad or m]."""
    moves: bool
    """Whether it still moves."""
    feels: bool
    """Whether the wrist's sensor gives its wrench."""
    ground: Ground | None
    """That all but the tool keeps above; None for none."""
    tool: ToolParams | None
    """At the arm's end."""
    gravity: float
    """Where the arm is [m/s2]."""


def named_pose(request: Unfold | Stow, beginning: Beginning) -> Task:
    """Go to the pose that has the task's name."""
    return Go(NamedGoal(request.task))


def place(request: Place, beginning: Beginning) -> Task:
    """See `Place`."""
    return Go(PoseGoal(request.position, request.direction))


def weigh(request: Weigh, beginning: Beginning) -> Task:
    """See `Weigh`."""
    return WeighTask(beginning.model, _weighing_postures(beginning.model, beginning.posture), request.seconds)


def dump(request: Dump, beginning: Beginning) -> Task:
    """See `Dump`. Raises GoalRefusedError without a scoop."""
    return DumpTask(_tool(request, beginning.tool, ScoopToolParams).lid.opening, request.seconds)


def release(request: Release, beginning: Beginning) -> Task:
    """See `Release`. Raises GoalRefusedError without a gripper."""
    return ReleaseTask(_tool(request, beginning.tool, GripperToolParams).stroke)


def tare(request: Tare, beginning: Beginning) -> Task:
    """See `Tare`. Raises GoalRefusedError without the wrist's sensor."""
    _feels(request, beginning)
    return TareTask(request.seconds, np.zeros(6))


def guarded_move(request: GuardedMove, beginning: Beginning) -> Task:
    """See `GuardedMove`. Raises GoalRefusedError without the wrist's sensor, or for a line that cannot be followed."""
    _feels(request, beginning)
    params, model, posture = beginning.params, beginning.model, beginning.posture
    start = forward_kinematics(model, posture).position
    direction = _direction(model, request.direction, posture)
    check_line(params, model, posture, direction, request.distance, beginning.ground)
    speed, way, retract = request.speed, request.distance, request.retract
    return _from_rest(GuardedMoveTask(direction, start, speed, request.force, way, retract, start), start, beginning)


def hold_force(request: HoldForce, beginning: Beginning) -> Task:
    """See `HoldForce`. Raises as `guarded_move`."""
    _feels(request, beginning)
    params, model, posture = beginning.params, beginning.model, beginning.posture
    start = forward_kinematics(model, posture).position
    direction = _direction(model, request.direction, posture)
    if request.distance > 0.0:
        check_line(params, model, posture, direction, request.distance, beginning.ground)
    seconds, tolerance, way = request.seconds, request.tolerance, request.distance
    return _from_rest(HoldForceTask(direction, start, request.force, seconds, tolerance, way), start, beginning)


def dig(request: Dig, beginning: Beginning) -> Task:
    """See `Dig`. Raises as `guarded_move`, and without a scoop."""
    lid = _tool(request, beginning.tool, ScoopToolParams).lid
    _feels(request, beginning)
    params, model, posture, ground = beginning.params, beginning.model, beginning.posture, beginning.ground
    start = forward_kinematics(model, posture).position
    direction = _direction(model, request.direction, posture)
    along = _across(direction, np.array(request.along or (-1.0, 0.0, 0.0)))
    into = request.depth
    reach = check_line(params, model, posture, direction, request.distance + into, ground, into)
    begun = reach[_first_below(model, reach, ground, into) - 1]
    end = check_line(params, model, begun, along, request.length, ground, into)[-1]
    check_line(params, model, end, -direction, into, ground, into)
    task = DigTask(
        direction,
        along,
        request.depth,
        request.length,
        request.speed,
        request.force,
        request.distance,
        first=start,
        touched=start,
        begun=start,
        lid=lid.opening,
    )
    return _from_rest(task, start, beginning)


def drill(request: Drill, beginning: Beginning) -> Task:
    """See `Drill`. Raises as `guarded_move`, without a drill, and for a rate that this one has not."""
    tool = _tool(request, beginning.tool, DrillToolParams)
    _feels(request, beginning)
    model, posture = beginning.model, beginning.posture
    start = forward_kinematics(model, posture).position
    rate = tool.rate if request.rate is None else request.rate
    if rate > tool.rate:
        raise GoalRefusedError(f"drill: rate = {rate:g} rad/s: allowed is at most {tool.rate:g}, the drill's own")
    direction = _direction(model, request.direction, posture)
    into = request.depth
    check_line(beginning.params, model, posture, direction, request.distance + into, beginning.ground, into)
    task = DrillTask(
        tool,
        direction,
        request.depth,
        request.force,
        rate,
        request.speed,
        request.patience,
        request.distance,
        first=start,
        touched=start,
        temperature=tool.heat.ambient,
    )
    return _from_rest(task, start, beginning)


def _from_rest(task: Task, place: FloatArray, beginning: Beginning) -> Task:
    """A task that leads the tip from `place` (3,) [m], where the arm rests."""
    return AtRest(task, place) if beginning.moves else task


def _feels(request: TaskRequest, beginning: Beginning) -> None:
    """Refuse a task of touch where the wrist's sensor does not give its wrench."""
    if not beginning.feels:
        raise GoalRefusedError(f"{request.task}: this arm feels no forces: its wrist's sensor says nothing")


def _tool(request: TaskRequest, tool: ToolParams | None, needed: type[Tool]) -> Tool:
    """The tool, if it is of the kind that a task needs."""
    if isinstance(tool, needed):
        return tool
    kind = needed.model_fields["kind"].annotation
    has = "carries no tool" if tool is None else f"carries a {tool.kind}"
    raise GoalRefusedError(f"{request.task}: this arm {has}: allowed is a {' or '.join(get_args(kind))}")


def pick(request: Pick, beginning: Beginning) -> Task:
    """See `Pick`. Raises GoalRefusedError without a gripper, or for a grasp force that it has not, or that does not
    hold the object.
    """
    gripper = _tool(request, beginning.tool, GripperToolParams)
    if request.force > gripper.force:
        raise GoalRefusedError(f"pick: force = {request.force:g} N: allowed is at most {gripper.force:g} N")
    if request.mass is not None and request.friction is not None:
        acceleration = beginning.gravity + beginning.params.force_control.tip_acceleration
        needed = grasp_needed(0.5 * gripper.stroke, request.mass, request.friction, acceleration)
        if needed > request.force:
            holds = f"{request.mass:g} kg with a friction of {request.friction:g}"
            raise GoalRefusedError(f"pick: force = {request.force:g} N: {holds} needs {needed:.1f} N or more")
    return PickTask(
        gripper,
        np.array(request.position),
        np.array(request.direction),
        request.force,
        request.lift,
        request.speed,
    )


def _across(direction: FloatArray, wanted: FloatArray) -> FloatArray:
    """Unit vector along `wanted`, square to the unit `direction`."""
    across = wanted - (direction @ wanted) * direction
    length = float(np.linalg.norm(across))
    if length < 0.1:
        raise GoalRefusedError("dig: along and direction are nearly the same: allowed is a furrow across the direction")
    return np.asarray(across / length)


def _weighing_postures(model: ArmModel, posture: FloatArray) -> tuple[FloatArray, ...]:
    """The present posture, and turned ones within the limits: each of the last three joints for itself."""
    postures = [posture]
    for joint in range(max(model.joint_count - 3, 0), model.joint_count):
        turned = posture.copy()
        middle = 0.5 * (model.lower[joint] + model.upper[joint])
        turned[joint] += TURN if posture[joint] < middle else -TURN
        postures.append(turned)
    return tuple(postures)


def _direction(model: ArmModel, asked: tuple[float, float, float] | None, posture: FloatArray) -> FloatArray:
    """Unit vector in base_link: as asked, or that of the tool."""
    return np.array(asked) if asked is not None else forward_kinematics(model, posture).tool_direction


def check_line(
    params: LineParams,
    model: ArmModel,
    posture: FloatArray,
    direction: FloatArray,
    distance: float,
    ground: Ground | None = None,
    depth: float = 0.0,
) -> FloatArray:
    """Postures (m, n) along a straight line of the tip with the tool's direction held.

    The tool is there to touch the ground: the links that may (`ground_contact_links`) are not checked against it, and
    the others only as far as the tip is at most `depth` [m] under it. Where it goes on without a contact there is no
    ground.

    Raises:
        GoalRefusedError: the arm cannot follow the whole line, or would collide with the rover, itself or the ground.
    """
    tip = forward_kinematics(model, posture)
    count = max(2, round(distance / _STEP) + 1)
    rows = [posture]
    for gone in np.linspace(0.0, distance, count)[1:]:
        place = tip.position + gone * direction
        found = nearby_solution(params, model, place, tip.tool_direction, rows[-1])
        if found is None or float(np.max(np.abs(found - rows[-1]))) > 0.3:
            reached = float(gone) - distance / (count - 1)
            raise GoalRefusedError(f"the arm can follow {reached * 1e3:.0f} mm of the {distance * 1e3:.0f} mm only")
        rows.append(found)
    postures = np.array(rows)
    collision = check_samples(params, model, refined(postures, params.collision_step), None, allow_start=True)
    if collision is None and ground is not None:
        touching = params.model_copy(update={"ground_contact_depth": math.inf, "seen_ground_depth": math.inf})
        near = refined(postures[: _first_below(model, postures, ground, depth)], params.collision_step)
        collision = check_samples(touching, model, near, ground, allow_start=True)
    if collision is not None:
        raise GoalRefusedError(collision.text())
    return postures


def _first_below(model: ArmModel, postures: FloatArray, ground: Ground | None, depth: float) -> int:
    """Number of the first posture after the start whose tip is more than `depth` under the ground; else how many."""
    if ground is not None:
        for k, posture in enumerate(postures[1:], start=1):
            if depth_below(ground, forward_kinematics(model, posture).position) > depth + 1e-6:
                return k
    return len(postures)
