"""Bench of the arm's planning: limits kept in every sample of motions to random goals; time of a plan through points.

Goals of every kind follow each other, some from rest and some while the arm is on its way, as the node plans them. What
a motion does is taken from its positions alone, by differences, and held against the limits of position, speed,
acceleration, torque and power. The figures are the largest shares of the limits; 1 is the limit.
"""

import math
import time

import numpy as np

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.goals import ArmGoal, JointGoal, NamedGoal, PoseGoal, TrajectoryGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.motion_load import motor_efforts, power_drawn
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.trajectory import JointReference, at_rest
from sojourn_flight.arm.ways import Departure
from sojourn_machine.params import FloatArray

WAY_POINTS = 5
PLAN_MS = 20.0
STEP = 2e-3
"""Of the differences [s]."""
SAMPLES = 24
"""Samples of a motion."""
KEPT = 1.0 + 1e-3
"""Differences over a change of jerk are off by less than this."""
LIMITS = ("position", "speed", "acceleration", "torque", "power")
TARGETS = {
    f"plan through {WAY_POINTS} points, median [ms]": ("<=", PLAN_MS),
    **{f"random goals, largest share of {name}": ("<=", KEPT) for name in LIMITS},
}


def plan_through_points(plans: int) -> dict[str, float]:
    """Planned, checked for collisions and limits, and timed: milliseconds."""
    scenario = load_scenario("flat_drive")
    params = scenario.carried_arm()
    arm, generator = build_arm_model(scenario.urdf_xml, params), np.random.default_rng(1)
    start, ground = np.array(params.named_poses["unfold"]), GroundPlane(-0.47)
    gravity = np.array([0.0, 0.0, -scenario.gravity])
    spans, done = [], 0
    for _ in range(plans):
        points = start + np.cumsum(generator.uniform(-0.4, 0.4, (WAY_POINTS, arm.joint_count)), axis=0)
        rows = tuple(tuple(row) for row in np.clip(points, arm.lower, arm.upper))
        goal = TrajectoryGoal(params.joint_names, (), rows)
        begin = time.perf_counter()
        try:
            plan_goal(params, arm, goal, Departure(at_rest(start), start), ground, gravity)
        except GoalRefusedError:
            continue
        spans.append(time.perf_counter() - begin)
        done += 1
    return {
        f"plan through {WAY_POINTS} points, median [ms]": 1e3 * float(np.median(spans)),
        f"plan through {WAY_POINTS} points, of ten the slowest [ms]": 1e3 * float(np.percentile(spans, 90)),
        f"plan through {WAY_POINTS} points, accepted [%]": 100.0 * done / plans,
    }


def random_goals(goals: int, seed: int = 1, power_limit: float | None = None) -> dict[str, float]:
    """Largest shares of the limits over motions to so many random goals.

    Args:
        power_limit: instead of that of the arm's file [W]; a small one makes it count.
    """
    scenario = load_scenario("flat_drive")
    params = scenario.carried_arm()
    if power_limit is not None:
        params = params.model_copy(update={"power_limit": power_limit})
    arm, generator = build_arm_model(scenario.urdf_xml, params), np.random.default_rng(seed)
    reference = at_rest(np.array(params.named_poses["unfold"]))
    shares, accepted, begin = np.zeros(len(LIMITS)), 0, time.perf_counter()
    for _ in range(goals):
        tilt = generator.normal(0.0, 0.15, 2)
        gravity = scenario.gravity * np.array([tilt[0], tilt[1], -math.sqrt(1.0 - min(float(tilt @ tilt), 0.9))])
        try:
            goal = _goal(params, arm, generator)
            plan = plan_goal(params, arm, goal, Departure(reference, reference.position), gravity=gravity)
        except GoalRefusedError:
            continue
        accepted += 1
        shares = np.maximum(shares, _shares(params, arm, plan.path, reference.position, gravity, generator))
        way = generator.uniform(0.0, 1.3)  # beyond the end: the next goal comes at rest
        reference = JointReference(*plan.path.sample(way * plan.path.duration)) if way < 1.0 else at_rest(plan.target)
    span = time.perf_counter() - begin
    return {
        "random goals": float(goals),
        "random goals, accepted [%]": 100.0 * accepted / goals,
        "random goals, time [s]": span,
        **{f"random goals, largest share of {name}": float(x) for name, x in zip(LIMITS, shares, strict=True)},
    }


def _goal(params: ArmParams, arm: ArmModel, generator: np.random.Generator) -> ArmGoal:
    kind, names = generator.uniform(), params.joint_names

    def joints() -> tuple[float, ...]:
        return tuple(generator.uniform(arm.lower, arm.upper))

    if kind < 0.6:
        return JointGoal(names, joints())
    if kind < 0.75:
        return TrajectoryGoal(names, (), (joints(), joints(), joints()))
    if kind < 0.85:
        return TrajectoryGoal(names, (generator.uniform(0.1, 5.0), generator.uniform(5.1, 30.0)), (joints(), joints()))
    if kind < 0.9:
        return NamedGoal("unfold")
    tip = forward_kinematics(arm, np.array(joints()))
    return PoseGoal(tuple(tip.position), tuple(tip.tool_direction))


def _shares(
    params: ArmParams,
    arm: ArmModel,
    path: JointPath,
    start: FloatArray,
    gravity: FloatArray,
    generator: np.random.Generator,
) -> FloatArray:
    """Share of each of LIMITS that a motion takes at random moments of it."""
    middle = generator.uniform(STEP, max(path.duration - STEP, STEP), SAMPLES)
    before, here, after = (path.samples(middle + shift) for shift in (-STEP, 0.0, STEP))
    speed, acceleration = (after - before) / (2.0 * STEP), (after - 2.0 * here + before) / STEP**2
    rigid = np.array([rigid_effort(arm, *row, gravity) for row in zip(here, speed, acceleration, strict=True)])
    motor = motor_efforts(params, rigid, speed)
    lower, upper = np.minimum(arm.lower, start), np.maximum(arm.upper, start)
    half = 0.5 * (upper - lower)
    limit = np.inf if params.power_limit is None else params.power_limit
    drawn = power_drawn(params, motor, speed)
    largest = arm.max_effort if not params.motor_effort else np.minimum(arm.max_effort, params.motor_effort)
    return np.array([
        np.max(np.abs(here - lower - half) / half),
        np.max(np.abs(speed) / arm.max_velocity),
        np.max(np.abs(acceleration) / arm.max_acceleration),
        np.max(np.abs(motor) / largest),
        np.max(drawn) / limit,
    ])  # fmt: skip
