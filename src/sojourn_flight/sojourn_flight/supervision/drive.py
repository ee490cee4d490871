"""The drive: one call a period from measurements and commands to motor commands, odometry and status.

Order of a period: refuse bad measurements; odometry; take the stop request, the new goal and the twist
command, newest first; the twist wanted (goal follower or operator), kept clear of obstacles (avoidance); limits of
the machine and of the power manager, all by one factor, and what its joints make of it (`mobility`). Everything
between two calls is in `DriveState`.

Rules: a goal ends the older goal; a twist command that came after the goal ends the goal; a stop request ends
both. A twist command older than cmd_vel_timeout stops the rover. A refused goal changes nothing else.

Sources and equations: see `odometry`, `goal_follower` and the kinds of `mobility`.
"""

import math
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from sojourn_flight.hazards.camera_watch import CameraState, speed_left, usable, watched
from sojourn_flight.mobility.easing import Behind, eased
from sojourn_flight.mobility.mobility import (
    BodyMotion,
    Conditions,
    InertialMeasurement,
    JointReferences,
    MobilityHealth,
    MobilityJoints,
    MotionInput,
)
from sojourn_flight.mobility.twist import NO_MOTION, PlanarTwist
from sojourn_flight.odometry import key_frames
from sojourn_flight.odometry.heading_fix import HeadingFixState, SunSighting, fix_heading, mounting_variances, turned_on
from sojourn_flight.odometry.odometry import (
    OdometryInput,
    OdometryState,
    initial_odometry,
    message_covariances,
    step_odometry,
)
from sojourn_flight.odometry.slip_estimation import SAMPLED_WITHIN
from sojourn_flight.odometry.visual_state import VisualOdometryState, rolled_on
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.follower_state import FollowerLimits, FollowerPhase, FollowerState
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.goal_follower import BESIDE, follow, stop
from sojourn_flight.supervision.arbiter import Arbiter
from sojourn_flight.supervision.astern import choose_sense, is_answered
from sojourn_flight.supervision.avoidance import (
    EXAMPLE_CLOUD,
    from_loose_ground,
    guide,
    initial_avoidance,
    see,
    warm_up_guard,
)
from sojourn_flight.supervision.drive_status import drive_status
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput, DriveState, Pace
from sojourn_flight.supervision.driven_machine import DrivenMachine
from sojourn_flight.supervision.foresight import foresee, foresight_status
from sojourn_flight.supervision.slip_policy import mean_slip, speed_part
from sojourn_machine.errors import InvalidValueError

LONGEST_PERIOD = 1.0
"""Longest period a step accepts [s]."""
LAST_STRETCH = 2.0
"""Of its way, on which a machine that stands waits until the correction of its place is in [m]."""


class DriveModel(DrivenMachine):
    """One machine and the laws that drive it; its state is a value, see `DriveState`."""

    def initial_state(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, z: float = 0.0) -> DriveState:
        """At rest at a pose of base_link in odom [m, rad]."""
        mounting, terrain = mounting_variances(self.params.heading_fix), self.terrain
        odometry = initial_odometry(self.params.odometry, x, y, yaw, z, mounting, self.key_frames)
        avoidance = initial_avoidance(self.avoidance, x, y) if self.avoidance is not None else None
        return DriveState(
            "idle",
            odometry,
            self.mobility.initial_state(),
            follower=None,
            last_outcome=None,
            since_override=math.inf,
            text="idle",
            avoidance=avoidance,
            terrain=None if terrain is None else key_frames.TerrainMatchState(),
            visual=None if self.visual is None else VisualOdometryState(),
        )

    def in_motion(self, state: DriveState) -> DriveState:
        """The state of a drive that begins, or goes on, while the machine may move already."""
        return replace(state, mobility=self.mobility.in_motion(state.mobility))

    def at_rest(self, state: DriveState) -> DriveOutput:
        """Output before the first step: nothing moves, the estimate is that of `state`."""
        pose_covariance, twist_covariance = message_covariances(self.params.odometry, state.odometry, 1.0)
        zero = np.zeros(len(self.mobility.joints))
        return DriveOutput(JointReferences(zero, zero), state.odometry, pose_covariance, twist_covariance, ())

    def step(self, state: DriveState, inputs: DriveInput, dt: float) -> tuple[DriveState, DriveOutput]:
        """One period, see `step`."""
        return step(self, state, inputs, dt)

    def warm_up(self) -> None:
        """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
        zeros, dt = np.zeros(len(self.mobility.joints)), 0.02
        state = self.initial_state()
        self.mobility.warm_up()
        if self.terrain is not None:
            key_frames.warm_up(self.terrain, state.odometry)
        if self.visual is not None:
            self.visual.warm_up(state.odometry)
        if self.avoidance is not None and state.avoidance is not None:
            warm_up_guard(self.avoidance, state.avoidance)
        level = InertialMeasurement((0.0, 0.0, 0.1), (0.0, 0.0, 1.0), (0.0, 0.0))
        for goal in (Goal.at(1.0, 1.0), None):
            moving = DriveInput(MobilityJoints(zeros, zeros + 1.0, zeros), level, goal=goal, cloud=EXAMPLE_CLOUD)
            state, _ = self.step(state, moving, dt)
        ahead = np.array((1.0, 0.0, 0.0))
        still = level._replace(gyro=(0.0, 0.0, 0.0))
        resting = DriveInput(MobilityJoints(zeros, zeros, zeros), still, sun=SunSighting(ahead, ahead), stop=True)
        for _ in range(round(2.0 * self.params.odometry.standing_time / dt)):
            state, _ = self.step(state, resting, dt)


def _check(inputs: DriveInput, dt: float) -> None:
    """What the mobility does not check itself."""
    if not (math.isfinite(dt) and 0.0 < dt <= LONGEST_PERIOD):
        raise InvalidValueError("dt", dt, f"above 0 s, at most {LONGEST_PERIOD} s")
    if not (math.isfinite(inputs.power_limit) and 0.0 <= inputs.power_limit <= 1.0):
        raise InvalidValueError("power_limit", inputs.power_limit, "0 to 1")
    felt = inputs.felt
    named = (("gyro", felt.gyro), ("specific force", felt.specific_force), ("roll and pitch", felt.roll_pitch))
    for name, values in named:
        if values is not None and not math.isfinite(sum(values)):
            raise InvalidValueError(name, values, "finite numbers")


def _mean_slip(model: DriveModel, state: DriveState, mobility: Any, odometry: OdometryState, dt: float) -> float:
    """The slip by which a goal is driven, see `slip_policy`; a rover that goes back or turns counts none."""
    back = state.avoidance is not None and state.avoidance.back is not None
    policy = model.params.slip_policy
    if policy is None or state.follower is None or back or state.follower.phase is not FollowerPhase.DRIVE:
        return 0.0
    slip = model.mobility.slip(mobility, odometry.slip_error, policy.least_pace)
    return mean_slip(policy, state.mean_slip, slip, dt)


class _Going(NamedTuple):
    """How the machine gets on in a period."""

    power: float
    """Factor of the power manager on all speeds [-]."""
    slip: float
    """Averaged, of the machine [-]."""
    no_headway: bool
    """What should move it moves, and it does not get on."""
    still: bool
    """Nothing is commanded to move."""
    rather_astern: bool
    """It would get on better backwards."""
    sight: float
    """Part of its speed that the hazard camera leaves [-]."""
    behind: float
    """Correction of its place that is not in the published pose yet [m]."""


def _would_miss(follower: GoalFollowerParams, way: FollowerState, behind: float, moving: bool) -> bool:
    """Whether the machine is so near to the end of its way that the correction to come [m] would find it beside its
    goal, with no way left to steer to it.
    """
    near = BESIDE * behind if moving else LAST_STRETCH
    return way.phase is FollowerPhase.DRIVE and behind > follower.room and way.distance_to_go < near


def _follow(model: DriveModel, arbiter: Arbiter, odometry: OdometryState, going: _Going, dt: float) -> PlanarTwist:
    """The goal follower's twist; notes the end of the goal."""
    way = arbiter.follower
    if way is None:
        return NO_MOTION
    power, slip, policy = going.power, going.slip, model.params.slip_policy
    if power <= 0.0:
        arbiter.text, arbiter.waits = "waiting for power", True
        return NO_MOTION
    slips = policy is not None and slip > policy.another_way
    sense = choose_sense(model, arbiter.avoidance, way, going.rather_astern, going.no_headway or slips, odometry)
    way, arbiter.follower, arbiter.avoidance = sense.way, sense.way, sense.seen
    if model.avoidance is not None and arbiter.avoidance is not None and not (way.astern or sense.observing):
        if policy is not None and slips:
            arbiter.avoidance = from_loose_ground(model.avoidance, arbiter.avoidance, odometry, policy, slip)
        guidance = guide(model.avoidance, arbiter.avoidance, way, odometry)
        arbiter.avoidance, arbiter.follower = guidance.state, guidance.way
        way = guidance.way
        if guidance.outcome is not None:
            arbiter.end_goal(guidance.outcome)
            return NO_MOTION
        if guidance.twist is not None:
            arbiter.text, arbiter.waits = guidance.text, True
            return guidance.twist
    moving = not going.still or math.hypot(odometry.v_x, odometry.v_y) > model.params.odometry.standing_speed
    if _would_miss(model.params.follower, way, going.behind, moving):
        arbiter.text, arbiter.waits = f"waits: its place is being corrected by {going.behind:.2f} m", True
        return NO_MOTION
    limits = model.params.limits
    pace = going.sight * (power if policy is None else power * speed_part(policy, slip))
    ability, slides = model.mobility.ability, model.params.odometry.turn_drift_per_grade
    able = FollowerLimits(
        limits.max_speed * pace,
        min(limits.max_yaw_rate, limits.max_speed / ability.turn_radius) * pace,
        limits.max_deceleration,
        limits.max_deceleration / ability.turn_radius,
        ability.turning,
        (slides * odometry.downhill[0], slides * odometry.downhill[1]),
    )
    pose = Pose(odometry.x, odometry.y, odometry.yaw)
    drift = None  # of a rover that hardly moves it is mostly noise
    side = -1.0 if way.astern else 1.0
    if side * odometry.v_x > model.params.odometry.standing_speed:
        drift = math.atan2(side * odometry.v_y, side * odometry.v_x)
    way, v_x, yaw_rate, outcome = follow(model.params.follower, way, pose, drift, moving, able, dt)
    arbiter.follower = way
    if outcome is not None:
        arbiter.end_goal(outcome)
        return NO_MOTION
    if sense.observing:
        arbiter.text, arbiter.waits = "looks where to drive astern", True
        return NO_MOTION
    astern = " astern" if way.astern else ""
    arbiter.text = f"{way.phase.value.replace('_', ' ')}{astern}, {way.distance_to_go:.2f} m to go"
    return PlanarTwist(v_x, 0.0, yaw_rate)


def step(model: DriveModel, state: DriveState, inputs: DriveInput, dt: float) -> tuple[DriveState, DriveOutput]:
    """One control period.

    Args:
        model: the machine.
        state: from `DriveModel.initial_state` or the last period; not changed.
        inputs: measurements and commands at the start of the period.
        dt: period [s].

    Raises:
        InvalidValueError: if a measurement is not finite or has a wrong shape; the state stays as it was.
    """
    _check(inputs, dt)
    params, felt = model.params, inputs.felt
    inputs, camera = _seen(model, state, inputs)
    standing = state.odometry.standing_for >= params.odometry.standing_time
    told = MotionInput(
        inputs.joints,
        felt,
        state.odometry.gyro_bias,
        standing,
        powered=inputs.power_limit > 0.0,
        new_goal=inputs.goal is not None,
    )
    mobility, motion = model.mobility.motion(state.mobility, told, dt)
    located = _locate(model, state, inputs, motion, dt)
    odometry, published = located.odometry, located.published
    avoidance = state.avoidance
    if model.avoidance is not None and avoidance is not None:
        avoidance = see(model.avoidance, avoidance, inputs.cloud, published, dt)
    arbiter = Arbiter(state.mode, state.follower, state.since_override + dt, state.text, [], state.energy, avoidance)
    if inputs.stop:
        arbiter.take_stop(inputs.stop_reason)
    if inputs.goal is not None:
        arbiter.take_goal(model, inputs.goal, published, inputs.supply)
    foreseen = state.foreseen
    if inputs.question is not None:
        found = foresee(model, arbiter.avoidance, inputs.question, published, inputs.supply)
        foreseen = foresight_status(model, found, inputs.supply)
    arbiter.watch_energy(model, inputs.supply, dt)
    wanted = arbiter.take_twist(model, inputs.twist, dt)
    health = model.mobility.health(mobility, odometry.slip_error)
    astern = arbiter.follower is not None and model.mobility.rather_astern(mobility)
    reason = _why_not(arbiter, health, astern)
    if arbiter.follower is not None and reason:
        arbiter.end_goal(stop(arbiter.follower, reason))
    slip_now = _mean_slip(model, state, mobility, odometry, dt)
    if arbiter.follower is not None:
        sight = 1.0 if params.obstacles is None else speed_left(params.obstacles.camera, camera)
        behind = math.hypot(*located.behind[:2])
        stuck, still = health.no_headway != "", motion.commanded_still
        going = _Going(inputs.power_limit, slip_now, stuck, still, astern, sight, behind)
        wanted = _follow(model, arbiter, published, going, dt)
    wanted = arbiter.keep_clear(model, wanted, published)

    mobility, moves = model.mobility.command(mobility, wanted, Conditions(inputs.power_limit, odometry.pitch), dt)
    if moves.stuck and arbiter.follower is not None:
        arbiter.end_goal(stop(arbiter.follower, moves.stuck))
    elif moves.waits and arbiter.follower is not None and wanted != NO_MOTION:
        arbiter.text, arbiter.waits = moves.waits, True
    new_state = DriveState(
        mode=arbiter.mode,
        odometry=odometry,
        mobility=mobility,
        follower=arbiter.follower,
        last_outcome=arbiter.outcomes[-1] if arbiter.outcomes else state.last_outcome,
        since_override=arbiter.since_override,
        text=arbiter.text,
        twist_refused=arbiter.twist_refused,
        waits=arbiter.waits,
        energy=arbiter.energy,
        mean_slip=slip_now,
        heading=located.heading,
        terrain=located.terrain,
        visual=located.visual,
        behind=located.behind,
        avoidance=arbiter.avoidance,
        camera=camera,
        foreseen=foreseen,
    )
    pose_covariance, twist_covariance = message_covariances(params.odometry, published, dt)
    pace = Pace(inputs.power_limit, moves)
    output = DriveOutput(
        moves.references,
        published,
        pose_covariance,
        twist_covariance,
        tuple(arbiter.outcomes),
        pace,
        partial(drive_status, model, new_state, pace),
    )
    return new_state, output


def _why_not(arbiter: Arbiter, health: MobilityHealth, rather_astern: bool) -> str:
    """Why the goal on its way ends here, in words; empty where it goes on."""
    reason = health.shortcoming
    if arbiter.follower is not None and not is_answered(arbiter.follower, rather_astern):
        reason = reason or health.no_headway
    return reason or health.lost


def _seen(model: DriveModel, state: DriveState, inputs: DriveInput) -> tuple[DriveInput, CameraState]:
    """The inputs without a cloud that does not tell of the ground that is there, and what is thought of the camera."""
    if model.params.obstacles is None or inputs.cloud is None:
        return inputs, state.camera
    camera = watched(model.params.obstacles.camera, state.camera, inputs.cloud)
    cloud = usable(camera, inputs.cloud)
    return (inputs if cloud is not None else replace(inputs, cloud=None)), camera


class _Located(NamedTuple):
    """Where the machine is after a period."""

    odometry: OdometryState
    published: OdometryState
    """As it is told: corrections go in by and by."""
    behind: Behind
    heading: HeadingFixState
    terrain: key_frames.TerrainMatchState | None
    visual: VisualOdometryState | None


def _locate(model: DriveModel, state: DriveState, inputs: DriveInput, motion: BodyMotion, dt: float) -> _Located:
    """The odometry with what Sun and cameras know."""
    params, felt = model.params, inputs.felt
    told = OdometryInput(motion, felt.gyro, felt.roll_pitch, max(dt - SAMPLED_WITHIN, 0.0))
    odometry = step_odometry(params.odometry, state.odometry, told, dt)
    rolled, heading, terrain, visual = odometry, state.heading, state.terrain, state.visual
    if params.heading_fix is not None:
        heading = turned_on(heading, odometry.yaw_rate, dt)
        if inputs.sun is not None:
            odometry, heading = fix_heading(params.heading_fix, odometry, heading, inputs.sun)
    if model.terrain is not None and terrain is not None and inputs.cloud is not None and felt.gyro is not None:
        odometry, terrain = key_frames.match_ground(model.terrain, odometry, terrain, inputs.cloud)
    if model.visual is not None and visual is not None:
        visual = rolled_on(visual, math.hypot(motion.v_x, motion.v_y), odometry.yaw_rate, dt)
        if inputs.images is not None:
            odometry, visual = model.visual.look(odometry, visual, inputs.images)
    # The way is kept to, and obstacles are, where the rover is said to be: the filter jumps at each look of the camera,
    # and each jump would jerk the steering.
    published, behind = eased(rolled, odometry, state.behind, dt)
    return _Located(odometry, published, behind, heading, terrain, visual)
