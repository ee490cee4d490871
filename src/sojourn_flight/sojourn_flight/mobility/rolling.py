"""Mobility of machines that roll: wheels, steered or fixed or with rollers, joints between two bodies, and tracks.

Order of a period. `motion`: which motors follow; slip from torques and acceleration, wheels that spin; the twist of
base_link that fits the wheels best. `command`: the limits of the machine by one factor; steering kinematics; slew
limits. A steering that has failed can only be where it is, and what failed wheels say is not believed.

Sources and equations: `kinematics`, `wheel_twist`, `wheel_commands`, `motor_watch`, `wheel_spin`, and `slip_estimation`
of the odometry.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.ability import Ability
from sojourn_flight.mobility.allowed_motion import AllowedMotion
from sojourn_flight.mobility.kinematics import limited_twist
from sojourn_flight.mobility.mobility import (
    BodyMotion,
    Conditions,
    InertialMeasurement,
    JointReferences,
    Mobility,
    MobilityHealth,
    MobilityJoints,
    MotionInput,
    Moves,
)
from sojourn_flight.mobility.motor_watch import (
    MeasuredMotors,
    MotorState,
    believable,
    commandable,
    dragging_sigma,
    failures,
    shortcoming,
    watch_motors,
)
from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.rolling_params import RollingParams
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, steering_geometry
from sojourn_flight.mobility.turning_limits import turning_limits
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_commands import WheelCommands, command_wheels, expected_slip
from sojourn_flight.mobility.wheel_period import WheelPeriod, wheel_motion
from sojourn_flight.mobility.wheel_spin import FeltMotion, WheelSpinState, endless_spin, rim_speed, step_spin
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_flight.odometry.slip_correction import counted_slip, dragging, no_headway
from sojourn_flight.odometry.slip_estimation import SlipInput, SlipModel, SlipState, estimate_slip
from sojourn_flight.odometry.slip_status import slip_status
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.body import MachineBody
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

WAITING = "wheels wait for the steering"


class MeasuredWheels(NamedTuple):
    """The joints, wheel by wheel. Arrays have shape (wheels,)."""

    positions: FloatArray
    """[rad]"""
    rates: FloatArray
    """[rad/s]"""
    angles: FloatArray
    """Of the steering [rad], 0 for fixed wheels."""
    efforts: FloatArray
    """Torques of the drives [N m]; shape (0,) where they are not measured."""


class WheelPlaces(NamedTuple):
    """How far the wheels have turned. Arrays have shape (wheels,)."""

    positions: FloatArray
    angles: FloatArray
    """Of wheels and steering [rad]."""


@dataclass(frozen=True, slots=True)
class RollingState:
    """What is remembered."""

    motors: MotorState
    """Which motors have failed."""
    limiter: LimiterState | None = None
    """Last commands; None before the first period, when the steering's present angles are taken over."""
    counted: WheelPlaces | None = None
    """Up to which the motion of the wheels has been told: while the machine stands, a creep adds up."""
    measured: WheelPlaces | None = None
    """The last ones; None before the first period."""
    slip: SlipState | None = None
    """None where it is not estimated."""
    spin: WheelSpinState = field(default_factory=WheelSpinState)
    """Speed by the accelerometer, of a machine that asks it."""
    stuck_for: float = 0.0
    """Time the wheels have waited for the steering [s]."""


class RollingMobility(Mobility[RollingState]):
    """A machine on wheels or tracks.

    Args:
        drive: how it is driven; its `mobility` is of kind rolling. geometry: wheels and tracks.
        loads: of the wheels, from `wheel_load_map`, shape (wheels, 3) [N]; None: slip is not estimated.
        joints: of the wheels, then of the steering; left out: those of the geometry, wheels by their own names.
        ride_height: of base_link over the ground [m].
    """

    def __init__(
        self,
        drive: DriveParams,
        geometry: SteeringGeometryParams,
        loads: FloatArray | None = None,
        joints: Sequence[str] = (),
        ride_height: float = 0.0,
    ) -> None:
        if not isinstance(drive.mobility, RollingParams):
            raise InvalidValueError("drive.mobility", drive.mobility.kind, "rolling")
        self.params, self.geometry, self.names = drive.mobility, geometry, geometry.names
        groups = [wheel.steer_group for wheel in geometry.wheels]
        steers = tuple(dict.fromkeys(group for group in groups if group is not None))
        self._steered = [place for place, group in enumerate(groups) if group is not None]
        self._turned_by = [len(groups) + steers.index(group) for group in groups if group is not None]
        self._first_of_steer = [groups.index(steer) for steer in steers]
        self.joints = tuple(joints) or (*self.names, *steers)
        self.table = geometry.table(self.params.track_ratio)
        self.limits = RollingLimits.of(drive.limits, self.params)
        self._expected, self._allowed = drive.odometry, AllowedMotion(self.table, self.names)
        slip = self.params.slip
        self.slip_model = None if slip is None or loads is None else SlipModel.of(slip, self.table, loads)
        self.ability = Ability(
            turning_limits(self.table, self.limits, drive.follower.max_curvature),
            max(math.hypot(wheel.x, wheel.y) for wheel in geometry.wheels),
            np.array([(wheel.x, wheel.y) for wheel in geometry.wheels]),
            ride_height,
        )

    @classmethod
    def of(cls, drive: DriveParams, params: RollingParams, body: MachineBody) -> "RollingMobility":
        """Of a machine as its files describe it."""
        loads = None
        if params.slip is not None:
            from sojourn_flight.mobility.wheel_load_map import wheel_load_map  # loads Pinocchio

            loads = wheel_load_map(body.urdf_xml, body.machine, body.gravity, body.stowed)
        joints = params.joints(body.machine)
        return cls(drive, steering_geometry(body.layout), loads, joints, body.layout.ride_height)

    def initial_state(self) -> RollingState:
        """See Mobility."""
        slip = None if self.slip_model is None else self.slip_model.initial_state()
        return RollingState(MotorState.unsuspected(len(self.names)), slip=slip)

    def in_motion(self, state: RollingState) -> RollingState:
        """See Mobility: nothing is known of the slip."""
        return state if self.slip_model is None else replace(state, slip=self.slip_model.initial_state(at_rest=False))

    def motion(self, state: RollingState, inputs: MotionInput, dt: float) -> tuple[RollingState, BodyMotion]:
        """See Mobility."""
        wheels, felt, limiter = self.wheels(inputs.joints), inputs.felt, state.limiter
        before = state.counted if inputs.standing else state.measured
        if before is None:
            before = WheelPlaces(wheels.positions - wheels.rates * dt, wheels.angles)
        motors = state.motors
        if limiter is not None and state.measured is not None and inputs.powered:
            seen = MeasuredMotors(wheels.angles, (wheels.angles - before.angles) / dt, wheels.rates, wheels.efforts)
            motors = watch_motors(self.params.motors, self.limits, self.table, motors, limiter, seen, dt)
        if inputs.new_goal:
            motors = motors.steering_on_trial()
        slip = self._step_slip(state, wheels, inputs, dt)
        lost, sigma = (slip.shared, slip.sigma) if slip is not None and slip.observable else (None, 0.0)
        spin, spinning = self._step_spin(state, commandable(self.table, motors), wheels, felt, dt)
        if spinning is not None:
            lost, sigma = spinning, self._expected.slip_sigma
        # What is told of the motion is told from the last period that counted, the rate of turn from the gyro.
        period = WheelPeriod(before.positions, wheels.positions, wheels.rates, before.angles, wheels.angles)
        turning = None if felt.gyro is None else float(felt.gyro[2] - inputs.gyro_bias)
        v_x, v_y, yaw_rate, residual, fastest, jumps = wheel_motion(
            believable(self.table, motors),
            period,
            float(dt),
            self.params.plausible_wheel_rate,
            self.params.lateral_weight,
            0.0 if turning is None else turning,
            turning is not None,
        )
        still = limiter is None or not np.count_nonzero(limiter.wheel_rates)
        drags = dragging_sigma(self.table, motors)
        told = BodyMotion(v_x, v_y, yaw_rate, residual, fastest, still, jumps, lost, sigma, drags)
        if limiter is None:
            limiter = LimiterState.at_rest(wheels.angles)
        places = WheelPlaces(wheels.positions, wheels.angles)
        return RollingState(motors, limiter, before, places, slip, spin, state.stuck_for), told

    def command(
        self, state: RollingState, wanted: PlanarTwist, conditions: Conditions, dt: float
    ) -> tuple[RollingState, Moves]:
        """See Mobility."""
        limiter, places = state.limiter, state.measured
        if limiter is None or places is None:
            raise InvalidValueError("commands before the first measurement", None, "motion first, then command")
        limits, power, transition, slip = self.limits, conditions.power, self.params.transition, 0.0
        if self.params.slip_feed_forward:
            slip = expected_slip(self._expected, conditions.pitch, wanted.v_x)
        table = commandable(self.table, state.motors)
        fastest_wheel = limits.max_wheel_rate * power * min(1.0 - slip, 1.0)
        twist, cut = limited_twist(table, wanted, limits.max_speed * power, limits.max_yaw_rate * power, fastest_wheel)
        commands = command_wheels(table, limits, transition, limiter, twist, places.angles, dt, slip)
        waits = commands.speed_factor <= 0.0
        stuck_for = state.stuck_for + dt if waits else 0.0
        stuck = self._stuck(commands, places) if waits and stuck_for > transition.stuck_timeout else ""
        moves = Moves(self.references(commands.state), cut, WAITING if waits else "", stuck, commands)
        return replace(state, limiter=commands.state, stuck_for=stuck_for), moves

    def fit(self, wanted: PlanarTwist) -> tuple[PlanarTwist, str]:
        """See Mobility and `allowed_motion`."""
        return self._allowed.fit(wanted)

    def health(self, state: RollingState, slip_error: float) -> MobilityHealth:
        """See Mobility."""
        return MobilityHealth(
            shortcoming(self.table, state.motors, self.names),
            no_headway(self.slip_model, state.slip, slip_error, self.names),
            endless_spin(self.params.spin, state.spin),
        )

    def slip(self, state: RollingState, slip_error: float, least_pace: float) -> float | None:
        """See Mobility."""
        return counted_slip(state.slip, slip_error, least_pace)

    def rather_astern(self, state: RollingState) -> bool:
        """Whether the wheels without motors would rather be behind."""
        failed = state.motors.drive_failed
        if not self.ability.turning.on_the_spot or not failed.any():
            return False
        return float(self.table[failed, WheelTableColumn.X].sum()) > 0.0

    def status(self, state: RollingState, moves: Moves, slip_error: float) -> dict[str, str | float]:
        """See Mobility."""
        commands: WheelCommands = moves.detail
        return {
            **slip_status(self.slip_model, state.slip, self.names, slip_error),
            "failed_motors": failures(state.motors, self.names),
            "steer_error_rad": commands.steer_error,
            "steering_residual_m_s": float(np.abs(commands.residual).max()),
            "speed_factor": commands.speed_factor,
        }

    def warm_up(self) -> None:
        """See Mobility."""
        zeros, state = np.zeros(len(self.joints)), self.initial_state()
        felt = InertialMeasurement((0.0, 0.0, 0.1), (0.0, 0.0, 1.0), (0.0, 0.0))
        for wanted in (PlanarTwist(0.0, 0.0, 0.0), PlanarTwist(0.1, 0.0, 0.1)):
            inputs = MotionInput(MobilityJoints(zeros, zeros + 1.0, zeros), felt, 0.0, False, True, False)
            state, _ = self.motion(state, inputs, 0.02)
            state, _ = self.command(state, wanted, Conditions(1.0, 0.0), 0.02)

    def wheels(self, joints: MobilityJoints) -> MeasuredWheels:
        """The joints, wheel by wheel. Raises InvalidValueError for a wrong shape, or a number that is not finite."""
        position = self._checked("position", joints.position)
        velocity = self._checked("rate", joints.velocity)
        effort = self._checked("effort", joints.effort) if len(joints.effort) else joints.effort
        count = len(self.names)
        angles = np.zeros(count)
        angles[self._steered] = position[self._turned_by]
        return MeasuredWheels(position[:count], velocity[:count], angles, effort[:count])

    def references(self, commands: LimiterState) -> JointReferences:
        """Rates of the wheels' joints, angles and rates of those of the steering."""
        count = len(self.names)
        position, velocity = np.zeros(len(self.joints)), np.empty(len(self.joints))
        velocity[:count] = commands.wheel_rates
        position[count:] = commands.steer_angles[self._first_of_steer]
        velocity[count:] = commands.steer_rates[self._first_of_steer]
        return JointReferences(position, velocity)

    def _step_slip(
        self, state: RollingState, wheels: MeasuredWheels, inputs: MotionInput, dt: float
    ) -> SlipState | None:
        """The slip; as it was where a measurement is missing, None where it is not estimated."""
        felt, model, limiter = inputs.felt, self.slip_model, state.limiter
        gyro, force, tilt = felt.gyro, felt.specific_force, felt.roll_pitch
        if model is None or state.slip is None or force is None or gyro is None or tilt is None:
            return state.slip
        if not len(wheels.efforts):
            return state.slip
        seen = SlipInput(
            wheels.rates,
            wheels.rates if limiter is None else limiter.wheel_rates,
            wheels.angles,
            wheels.efforts,
            np.array((gyro[0], gyro[1], gyro[2] - inputs.gyro_bias)),
            np.array(force),
            tilt,
        )
        found = estimate_slip(model, state.slip, seen, dt)
        return dragging(found) if np.count_nonzero(state.motors.drive_failed) else found

    def _step_spin(
        self, state: RollingState, table: FloatArray, wheels: MeasuredWheels, felt: InertialMeasurement, dt: float
    ) -> tuple[WheelSpinState, float | None]:
        """The state of the spin, and the slip of wheels that do; None of those that do not."""
        params = self.params.spin
        if params is None or felt.specific_force is None or felt.roll_pitch is None:
            return state.spin, None
        rim = rim_speed(table, wheels.rates, wheels.angles)
        usual = expected_slip(self._expected, felt.roll_pitch[1], rim)
        yaw_rate = 0.0 if felt.gyro is None else felt.gyro[2]
        motion = FeltMotion(felt.specific_force, *felt.roll_pitch, yaw_rate, felt.accelerometer_ahead)
        return step_spin(params, state.spin, rim, usual, motion, dt)

    def _stuck(self, commands: WheelCommands, places: WheelPlaces) -> str:
        worst = int(np.argmax(np.abs(commands.wanted_angles - places.angles)))
        return (
            f"steering of {self.names[worst]} does not reach its angle: "
            f"{places.angles[worst]:.3f} rad measured, {commands.wanted_angles[worst]:.3f} rad wanted"
        )

    def _checked(self, what: str, values: FloatArray) -> FloatArray:
        """A copy of a measurement as the kernels want it."""
        array = np.array(values, dtype=np.float64)
        if array.shape != (len(self.joints),):
            raise InvalidValueError(f"shape of joint {what}", array.shape, f"({len(self.joints)},), one for each joint")
        bad = _first_bad(array)
        if bad >= 0:
            raise InvalidValueError(f"{what} of {self.joints[bad]}", float(array[bad]), "a finite number")
        return array


@njit(cache=True)
def _first_bad(values: FloatArray) -> int:
    """Index of the first number that is not finite, -1 if there is none."""
    for i in range(values.shape[0]):
        if not math.isfinite(values[i]):
            return i
    return -1
