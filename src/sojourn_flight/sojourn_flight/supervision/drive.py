"""The drive: one call a period from measurements and commands to motor commands, odometry and status.

Order of a period: refuse bad measurements; odometry; take the stop request, the new goal and the twist
command, newest first; the twist wanted (goal follower or operator), kept clear of obstacles (avoidance); limits of
the machine and of the power manager, all by one factor; steering kinematics; slew limits. Everything between two
calls is in `DriveState`.

Rules: a goal ends the older goal; a twist command that came after the goal ends the goal; a stop request ends
both. A twist command older than cmd_vel_timeout stops the rover. A refused goal changes nothing else.

Sources and equations: see kinematics, rate_limiter, odometry and goal_follower of this chapter.
"""

import math
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.easing import eased
from sojourn_flight.mobility.kinematics import PlanarTwist, limited_twist
from sojourn_flight.mobility.motor_watch import (
    NOT_MEASURED,
    MeasuredMotors,
    MotorState,
    believable,
    commandable,
    dragging_sigma,
    shortcoming,
    watch_motors,
)
from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.wheel_commands import command_wheels, expected_slip
from sojourn_flight.mobility.wheel_spin import FeltMotion, endless_spin, rim_speed, step_spin
from sojourn_flight.odometry import key_frames
from sojourn_flight.odometry.heading_fix import SunSighting, fix_heading, mounting_variances, turned_on
from sojourn_flight.odometry.odometry import (
    OdometryInput,
    OdometryState,
    initial_odometry,
    message_covariances,
    step_odometry,
)
from sojourn_flight.odometry.slip_correction import counted_slip, no_headway, step_slip
from sojourn_flight.odometry.slip_estimation import SlipState
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.goal_follower import FollowerLimits, FollowerPhase, follow, stop
from sojourn_flight.supervision.arbiter import NO_MOTION, Arbiter
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
from sojourn_flight.supervision.slip_policy import mean_slip, speed_part
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

LONGEST_PERIOD = 1.0
"""Longest period a step accepts [s]."""


class DriveModel(DrivenMachine):
    """One machine and the laws that drive it; its state is a value, see `DriveState`."""

    def initial_state(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> DriveState:
        """At rest at a pose in odom [m, rad]."""
        mounting, terrain = mounting_variances(self.params.heading_fix), self.terrain
        odometry = initial_odometry(self.params.odometry, x, y, yaw, mounting, key_frames=terrain is not None)
        motors = MotorState.unsuspected(len(self.table))
        avoidance = initial_avoidance(self.avoidance, x, y) if self.avoidance is not None else None
        slip = None if self.slip is None else self.slip.initial_state()
        return DriveState(
            "idle",
            odometry,
            None,
            None,
            None,
            math.inf,
            0.0,
            motors,
            "idle",
            avoidance=avoidance,
            slip=slip,
            terrain=None if terrain is None else key_frames.TerrainMatchState(),
        )

    def at_rest(self, state: DriveState) -> DriveOutput:
        """Output before the first step: nothing moves, the estimate is that of `state`."""
        pose_covariance, twist_covariance = message_covariances(self.params.odometry, state.odometry, 1.0)
        zero = np.zeros(self.table.shape[0])
        return DriveOutput(zero, zero, zero, state.odometry, pose_covariance, twist_covariance, ())

    def step(self, state: DriveState, inputs: DriveInput, dt: float) -> tuple[DriveState, DriveOutput]:
        """One period, see `step`."""
        return step(self, state, inputs, dt)

    def warm_up(self) -> None:
        """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
        wheels, dt = np.zeros(self.table.shape[0]), 0.02
        state = self.initial_state()
        if self.terrain is not None:
            key_frames.warm_up(self.terrain, state.odometry)
        if self.avoidance is not None and state.avoidance is not None:
            warm_up_guard(self.avoidance, state.avoidance)
        for goal in (Goal.at(1.0, 1.0), None):
            turning = DriveInput(
                wheels, wheels + 1.0, wheels, wheels, (0.0, 0.0, 0.1), (0.0, 0.0, 1.0), (0.0, 0.0), goal=goal
            )
            turning = replace(turning, cloud=EXAMPLE_CLOUD)
            state, _ = self.step(state, turning, dt)
        resting = DriveInput(
            wheels,
            wheels,
            wheels,
            wheels,
            gyro=(0.0, 0.0, 0.0),
            specific_force=(0.0, 0.0, 1.0),
            roll_pitch=(0.0, 0.0),
            stop=True,
        )
        resting = replace(resting, sun=SunSighting(np.array((1.0, 0.0, 0.0)), np.array((1.0, 0.0, 0.0))))
        for _ in range(round(2.0 * self.params.odometry.standing_time / dt)):
            state, _ = self.step(state, resting, dt)


@njit(cache=True)
def _first_bad(values: FloatArray) -> int:
    """Index of the first number that is not finite, -1 if there is none."""
    for i in range(values.shape[0]):
        if not math.isfinite(values[i]):
            return i
    return -1


def _measured_array(model: DriveModel, name: str, values: FloatArray) -> FloatArray:
    """A copy of a measurement as the kernels want it."""
    array = np.array(values, dtype=np.float64)
    if array.shape != (model.table.shape[0],):
        raise InvalidValueError(f"shape of {name}", array.shape, f"({model.table.shape[0]},), one for each wheel")
    bad = _first_bad(array)
    if bad >= 0:
        wheel = model.geometry.wheels[bad].name
        raise InvalidValueError(f"{name} of {wheel}", float(array[bad]), "a finite number")
    return array


def _measured(model: DriveModel, state: DriveState, inputs: DriveInput, dt: float) -> OdometryInput:
    """Measurements, checked."""
    if not (math.isfinite(dt) and 0.0 < dt <= LONGEST_PERIOD):
        raise InvalidValueError("dt", dt, f"above 0 s, at most {LONGEST_PERIOD} s")
    if not (math.isfinite(inputs.power_limit) and 0.0 <= inputs.power_limit <= 1.0):
        raise InvalidValueError("power_limit", inputs.power_limit, "0 to 1")
    force = inputs.specific_force
    for name, values in (("gyro", inputs.gyro), ("specific force", force), ("roll and pitch", inputs.roll_pitch)):
        if values is not None and not math.isfinite(sum(values)):
            raise InvalidValueError(name, values, "finite numbers")
    limiter = state.limiter
    return OdometryInput(
        _measured_array(model, "wheel position", inputs.wheel_positions),
        _measured_array(model, "wheel rate", inputs.wheel_rates),
        _measured_array(model, "steer angle", inputs.steer_angles),
        inputs.gyro,
        inputs.roll_pitch,
        commanded_still=limiter is None or not np.count_nonzero(limiter.wheel_rates),
    )


def _mean_slip(
    model: DriveModel, state: DriveState, slip: SlipState | None, odometry: OdometryState, dt: float
) -> float:
    """The slip by which a goal is driven, see `slip_policy`; a rover that goes back or turns counts none."""
    back = state.avoidance is not None and state.avoidance.back is not None
    policy = model.params.slip_policy
    if policy is None or state.follower is None or back or state.follower.phase is not FollowerPhase.DRIVE:
        return 0.0
    return mean_slip(policy, state.mean_slip, counted_slip(slip, odometry, policy.least_pace), dt)


class _Going(NamedTuple):
    """How the machine gets on in a period."""

    power: float
    """Factor of the power manager on all speeds [-]."""
    slip: float
    """Averaged, of the machine [-]."""
    spinning: bool
    """Wheels spin without headway."""
    still: bool
    """Nothing is commanded to move."""
    motors: MotorState


def _follow(model: DriveModel, arbiter: Arbiter, odometry: OdometryState, going: _Going, dt: float) -> PlanarTwist:
    """The goal follower's twist; notes the end of the goal."""
    way = arbiter.follower
    if way is None:
        return NO_MOTION
    power, slip, policy = going.power, going.slip, model.params.slip_policy
    if power <= 0.0:
        arbiter.text = f"waiting for power, {way.distance_to_go:.2f} m to go"
        return NO_MOTION
    slips = policy is not None and slip > policy.another_way
    sense = choose_sense(model, arbiter.avoidance, way, going.motors, going.spinning or slips, odometry)
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
            arbiter.text = guidance.text
            return guidance.twist
    limits = model.params.limits
    pace = power if policy is None else power * speed_part(policy, slip)
    moving = not going.still or math.hypot(odometry.v_x, odometry.v_y) > model.params.odometry.standing_speed
    able = FollowerLimits(
        limits.max_speed * pace,
        min(limits.max_yaw_rate, limits.max_speed / model.turn_radius) * pace,
        limits.max_deceleration,
        limits.max_deceleration / model.turn_radius,
        model.turning,
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
        arbiter.text = f"looks where to drive astern, {way.distance_to_go:.2f} m to go"
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
    measured = _measured(model, state, inputs, dt)
    params, limiter = model.params, state.limiter
    motors = state.motors if limiter is None else _watch(model, state, limiter, inputs, measured, dt)
    if inputs.goal is not None:
        motors = motors.steering_on_trial()
    table = commandable(model.table, motors)
    slipping = step_slip(model.slip, state, inputs, measured, dt)
    if np.count_nonzero(motors.drive_failed):
        measured = replace(measured, turn_sigma=dragging_sigma(model.table, motors))
    if slipping is not None and slipping.observable:
        measured = replace(measured, slip=slipping.shared, slip_sigma=slipping.sigma)
    spin = state.spin
    if params.spin is not None and inputs.specific_force is not None and inputs.roll_pitch is not None:
        rim = rim_speed(table, measured.wheel_rates, measured.steer_angles)
        usual = expected_slip(params.odometry, inputs.roll_pitch[1], rim)
        yaw_rate = 0.0 if inputs.gyro is None else inputs.gyro[2]
        felt = FeltMotion(inputs.specific_force, *inputs.roll_pitch, yaw_rate, inputs.accelerometer_ahead)
        spin, spinning = step_spin(params.spin, spin, rim, usual, felt, dt)
        if spinning is not None:
            measured = replace(measured, slip=spinning, slip_sigma=params.odometry.slip_sigma)
    odometry = step_odometry(params.odometry, believable(model.table, motors), state.odometry, measured, dt)
    rolled, heading, terrain = odometry, state.heading, state.terrain
    if params.heading_fix is not None:
        heading = turned_on(heading, odometry.yaw_rate, dt)
        if inputs.sun is not None:
            odometry, heading = fix_heading(params.heading_fix, odometry, heading, inputs.sun)
    if model.terrain is not None and terrain is not None and inputs.cloud is not None and inputs.gyro is not None:
        odometry, terrain = key_frames.match_ground(model.terrain, odometry, terrain, inputs.cloud)
    # The way is kept to, and obstacles are, where the rover is said to be: the filter jumps at each look of the camera,
    # and each jump would jerk the steering.
    published, behind = eased(rolled, odometry, state.behind, dt)
    if limiter is None:
        limiter = LimiterState.at_rest(measured.steer_angles)

    avoidance = state.avoidance
    if model.avoidance is not None and avoidance is not None:
        avoidance = see(model.avoidance, avoidance, inputs.cloud, published, dt)
    arbiter = Arbiter(state.mode, state.follower, state.since_override + dt, state.text, [], state.energy, avoidance)
    if inputs.stop:
        arbiter.take_stop(inputs.stop_reason)
    if inputs.goal is not None:
        arbiter.take_goal(model, inputs.goal, published, inputs.supply)
    arbiter.watch_energy(model, inputs.supply, dt)
    wanted = arbiter.take_twist(model, inputs.twist, dt)
    reason = shortcoming(model.table, motors, model.names)
    lost = no_headway(model.slip, slipping, odometry, model.names)
    if arbiter.follower is not None and not is_answered(model, arbiter.follower, motors):
        reason = reason or lost
    reason = reason or endless_spin(params.spin, spin)
    if arbiter.follower is not None and reason:
        arbiter.end_goal(stop(arbiter.follower, reason))
    slip_now = _mean_slip(model, state, slipping, odometry, dt)
    if arbiter.follower is not None:
        going = _Going(inputs.power_limit, slip_now, lost != "", measured.commanded_still, motors)
        wanted = _follow(model, arbiter, published, going, dt)
    wanted = arbiter.keep_clear(model, wanted, published)

    limits, power = params.limits, inputs.power_limit
    slip = 0.0
    if params.slip_feed_forward:
        slip = expected_slip(params.odometry, odometry.pitch, wanted.v_x)
    fastest_wheel = limits.max_wheel_rate * power * min(1.0 - slip, 1.0)
    twist, cut = limited_twist(table, wanted, limits.max_speed * power, limits.max_yaw_rate * power, fastest_wheel)
    limited = command_wheels(table, limits, params.transition, limiter, twist, measured.steer_angles, dt, slip)
    waiting = limited.speed_factor <= 0.0
    stuck_for = state.stuck_for + dt if waiting else 0.0
    if waiting and arbiter.follower is not None and stuck_for > params.transition.stuck_timeout:
        worst = int(np.argmax(np.abs(limited.wanted_angles - measured.steer_angles)))
        arbiter.end_goal(
            stop(
                arbiter.follower,
                f"steering of {model.geometry.wheels[worst].name} does not reach its angle: "
                f"{measured.steer_angles[worst]:.3f} rad measured, {limited.wanted_angles[worst]:.3f} rad wanted",
            )
        )
    elif waiting and wanted != NO_MOTION:
        arbiter.text += " (wheels wait for the steering)"
    last_outcome = arbiter.outcomes[-1] if arbiter.outcomes else state.last_outcome
    new_state = DriveState(
        mode=arbiter.mode,
        odometry=odometry,
        limiter=limited.state,
        follower=arbiter.follower,
        last_outcome=last_outcome,
        since_override=arbiter.since_override,
        stuck_for=stuck_for,
        motors=motors,
        text=arbiter.text,
        twist_refused=arbiter.twist_refused,
        energy=arbiter.energy,
        slip=slipping,
        mean_slip=slip_now,
        spin=spin,
        heading=heading,
        terrain=terrain,
        behind=behind,
        avoidance=arbiter.avoidance,
    )
    pose_covariance, twist_covariance = message_covariances(params.odometry, published, dt)
    pace = Pace(inputs.power_limit, cut, limited)
    output = DriveOutput(
        limited.state.wheel_rates,
        limited.state.steer_angles,
        limited.state.steer_rates,
        published,
        pose_covariance,
        twist_covariance,
        tuple(arbiter.outcomes),
        pace,
        partial(drive_status, model, new_state, pace),
    )
    return new_state, output


def _watch(
    model: DriveModel,
    state: DriveState,
    commanded: LimiterState,
    inputs: DriveInput,
    measured: OdometryInput,
    dt: float,
) -> MotorState:
    """What is thought of the motors; they learn nothing while the power manager holds them."""
    last = state.odometry.steer_angles
    if last is None or inputs.power_limit <= 0.0:
        return state.motors
    efforts = NOT_MEASURED
    if inputs.wheel_efforts is not None:
        efforts = _measured_array(model, "wheel effort", inputs.wheel_efforts)
    steer_rates = (measured.steer_angles - last) / dt
    motors = MeasuredMotors(measured.steer_angles, steer_rates, measured.wheel_rates, efforts)
    params = model.params
    return watch_motors(params.motors, params.limits, model.table, state.motors, commanded, motors, dt)
