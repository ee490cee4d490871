"""The drive of a rolling machine, wheel by wheel: tests say what each wheel does and see what each is told to do."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_flight.mobility.mobility import NOT_MEASURED, BodyMotion, InertialMeasurement, MobilityJoints
from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.rolling import RollingMobility
from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.wheel_period import WheelPeriod, wheel_motion
from sojourn_flight.odometry.odometry import OdometryInput, OdometryState, initial_odometry, step_odometry
from sojourn_flight.odometry.odometry_params import OdometryParams
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput, DriveState
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray

PLAUSIBLE_RATE, LATERAL_WEIGHT = 10.0, 1.0
"""Of the explorer."""


@dataclass(frozen=True)
class WheelInput:
    """A DriveInput of wheels: arrays have shape (wheels,)."""

    wheel_positions: FloatArray
    wheel_rates: FloatArray
    steer_angles: FloatArray
    wheel_efforts: FloatArray | None = None
    gyro: tuple[float, float, float] | None = None
    specific_force: tuple[float, float, float] | None = None
    roll_pitch: tuple[float, float] | None = None
    accelerometer_ahead: float = 0.0
    sun: Any = None
    cloud: Any = None
    twist: Any = None
    goal: Any = None
    stop: bool = False
    stop_reason: str = "stop requested"
    supply: Any = None
    power_limit: float = 1.0


@dataclass(frozen=True)
class WheelOutput(DriveOutput):
    """A DriveOutput with the commands of each wheel."""

    commands: LimiterState = LimiterState.at_rest(np.zeros(0))  # noqa: RUF009

    @property
    def wheel_rates(self) -> FloatArray:
        return self.commands.wheel_rates

    @property
    def steer_angles(self) -> FloatArray:
        return self.commands.steer_angles

    @property
    def steer_rates(self) -> FloatArray:
        return self.commands.steer_rates


class WheelDrive(DriveModel):
    """A DriveModel whose inputs and outputs are by wheels."""

    mobility: RollingMobility

    def __init__(
        self,
        params: DriveParams,
        geometry: SteeringGeometryParams,
        camera: StereoCamera | None = None,
        loads: FloatArray | None = None,
    ) -> None:
        super().__init__(params, RollingMobility(params, geometry, loads), camera)

    @property
    def geometry(self) -> SteeringGeometryParams:
        return self.mobility.geometry

    @property
    def table(self) -> FloatArray:
        return self.mobility.table

    def at_rest(self, state: DriveState) -> WheelOutput:
        output = super().at_rest(state)
        return self._by_wheels(output, LimiterState.at_rest(np.zeros(len(self.table))))

    def step(self, state: DriveState, inputs: Any, dt: float) -> tuple[DriveState, WheelOutput]:
        state, output = super().step(state, self.by_joints(inputs), dt)
        return state, self._by_wheels(output, state.mobility.limiter)

    def by_joints(self, inputs: Any) -> DriveInput:
        """The input as the drive takes it."""
        if isinstance(inputs, DriveInput):
            return inputs
        groups = [wheel.steer_group for wheel in self.geometry.wheels]
        first = [groups.index(name) for name in self.mobility.joints[len(groups) :]]
        angles = np.asarray(inputs.steer_angles, dtype=np.float64)[first]
        still = np.zeros(len(first))
        efforts = NOT_MEASURED if inputs.wheel_efforts is None else np.append(inputs.wheel_efforts, still)
        joints = MobilityJoints(
            np.append(inputs.wheel_positions, angles), np.append(inputs.wheel_rates, still), efforts
        )
        felt = InertialMeasurement(inputs.gyro, inputs.specific_force, inputs.roll_pitch, inputs.accelerometer_ahead)
        names = ("sun", "cloud", "twist", "goal", "stop", "stop_reason", "supply", "power_limit")
        return DriveInput(joints, felt, **{name: getattr(inputs, name) for name in names})

    def _by_wheels(self, output: DriveOutput, commands: LimiterState) -> WheelOutput:
        return WheelOutput(**{field.name: getattr(output, field.name) for field in fields(output)}, commands=commands)


def drive_of(scenario: LoadedScenario, camera: StereoCamera | None = None, **changes: Any) -> WheelDrive:
    """The drive of a scenario, with other parameters."""
    params = scenario.drive.model_copy(update=changes)
    return WheelDrive(params, scenario.steering, camera)


def wheel_loads_of(scenario: LoadedScenario) -> FloatArray:
    """What the drive believes that the wheels carry, shape (wheels, 3) [N]."""
    mobility = scenario.mobility()
    assert isinstance(mobility, RollingMobility) and mobility.slip_model is not None
    return mobility.slip_model.machine.loads


def rolling_limits(params: DriveParams) -> RollingLimits:
    """The limits of a rolling machine."""
    return RollingLimits.of(params.limits, params.mobility)


def with_mobility(params: DriveParams, **changes: Any) -> DriveParams:
    """The parameters with others of the mobility."""
    return params.model_copy(update={"mobility": params.mobility.model_copy(update=changes)})


@dataclass(frozen=True)
class WheelMeasured:
    """An OdometryInput of wheels: arrays have shape (wheels,)."""

    wheel_positions: FloatArray
    wheel_rates: FloatArray
    steer_angles: FloatArray
    gyro: tuple[float, float, float] | None = None
    roll_pitch: tuple[float, float] | None = None
    commanded_still: bool = False
    slip: float | None = None
    slip_sigma: float = 0.0
    turn_sigma: float = 0.0


@dataclass(frozen=True)
class WheelOdometry(OdometryState):
    """An OdometryState with the wheels as they were when it was told."""

    wheel_positions: FloatArray | None = None
    steer_angles: FloatArray | None = None


OF_ODOMETRY = tuple(field.name for field in fields(OdometryState))


def initial_wheels(*arguments: Any, **options: Any) -> WheelOdometry:
    """As `initial_odometry`."""
    return _with_wheels(initial_odometry(*arguments, **options), None, None)


def step_wheels(
    params: OdometryParams,
    table: FloatArray,
    state: WheelOdometry,
    measured: WheelMeasured,
    dt: float,
    unread: float = 0.0,
) -> WheelOdometry:
    """The odometry after a period of wheels that are measured so, in which no gyro was read for a while."""
    before, angles_before = state.wheel_positions, state.steer_angles
    if before is None or angles_before is None:
        before, angles_before = measured.wheel_positions - measured.wheel_rates * dt, measured.steer_angles
    gyro, angles = measured.gyro, measured.steer_angles
    period = WheelPeriod(before, measured.wheel_positions, measured.wheel_rates, angles_before, angles)
    turning = 0.0 if gyro is None else float(gyro[2] - state.gyro_bias)
    v_x, v_y, yaw_rate, residual, fastest, jumps = wheel_motion(
        table, period, dt, PLAUSIBLE_RATE, LATERAL_WEIGHT, turning, gyro is not None
    )
    motion = BodyMotion(
        v_x, v_y, yaw_rate, residual, fastest, measured.commanded_still, jumps,
        measured.slip, measured.slip_sigma, measured.turn_sigma,
    )  # fmt: skip
    after = step_odometry(params, state, OdometryInput(motion, gyro, measured.roll_pitch, unread), dt)
    if after.standing_for >= params.standing_time:  # a creep adds up
        return _with_wheels(after, state.wheel_positions, state.steer_angles)
    return _with_wheels(after, measured.wheel_positions, measured.steer_angles)


def _with_wheels(odometry: OdometryState, positions: Any, angles: Any) -> WheelOdometry:
    known = {name: getattr(odometry, name) for name in OF_ODOMETRY}
    return WheelOdometry(**known, wheel_positions=positions, steer_angles=angles)
