"""The explorer's wheels, the parameters the drive node ships with, and a machine that obeys kinematically."""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from placements import geometry_from_placements
from sojourn_config.bundle import read_machine
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.wheel_twist import twist_from_wheels
from sojourn_flight.supervision.drive_types import DriveState
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray
from wheel_drive import WheelDrive, WheelInput, WheelOutput

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def drive_params() -> DriveParams:
    """What the drive node ships with, for ground on which no slip is expected."""
    shipped = read_machine("explorer", "moon", "lunar_nominal").drive
    firm = {"mean_slip": 0.0, "slip_per_grade": 0.0, "side_slip_per_grade": 0.0, "turn_drift_per_grade": 0.0}
    return shipped.model_copy(update={"odometry": shipped.odometry.model_copy(update=firm)})


@pytest.fixture(scope="session")
def explorer() -> SteeringGeometryParams:
    """Six wheels, four steered corners: wheelbase 1.41 m, track 1.06 m, wheel diameter 0.25 m."""
    names = ["front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right"]
    positions = [(x, y, -0.3) for x in (0.705, 0.0, -0.705) for y in (0.53, -0.53)]
    steer = (-1.6, 1.6)
    return geometry_from_placements(names, positions, [0.125] * 6, [steer, steer, None, None, steer, steer])


@pytest.fixture(scope="session")
def model(drive_params: DriveParams, explorer: SteeringGeometryParams) -> WheelDrive:
    """The explorer's drive."""
    return WheelDrive(drive_params, explorer)


@dataclass
class Machine:
    """Motors that obey in one period, on plane ground, with slip of all wheels; truth and measurements."""

    model: WheelDrive
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    slip: float = 0.0
    gyro_bias: float = 0.0
    stuck_steering: bool = False
    stuck_wheels: bool = False
    wheel_positions: FloatArray = field(init=False)
    wheel_rates: FloatArray = field(init=False)
    steer_angles: FloatArray = field(init=False)
    yaw_rate: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.model.geometry.wheels)
        self.wheel_positions, self.wheel_rates = np.zeros(count), np.zeros(count)
        self.steer_angles = np.zeros(count)

    def measure(self, **commands: object) -> WheelInput:
        """Measurements, with the commands of this period."""
        return WheelInput(
            self.wheel_positions,
            self.wheel_rates,
            self.steer_angles,
            gyro=(0.0, 0.0, self.yaw_rate + self.gyro_bias),
            **commands,  # type: ignore[arg-type]
        )

    def move(self, output: WheelOutput, dt: float) -> None:
        """One period under the commands."""
        middle = self.steer_angles
        if not self.stuck_steering:
            middle = 0.5 * (self.steer_angles + output.steer_angles)
            self.steer_angles = output.steer_angles
        self.wheel_rates = output.wheel_rates
        self.wheel_positions = self.wheel_positions + output.wheel_rates * dt
        v_x, v_y, yaw_rate, _ = twist_from_wheels(
            self.model.table, output.wheel_rates, middle, steer_rates=output.steer_rates
        )
        grip = 0.0 if self.stuck_wheels else 1.0 - self.slip
        self.yaw_rate = grip * yaw_rate
        heading = self.yaw + 0.5 * self.yaw_rate * dt
        self.x += grip * dt * (math.cos(heading) * v_x - math.sin(heading) * v_y)
        self.y += grip * dt * (math.sin(heading) * v_x + math.cos(heading) * v_y)
        self.yaw += self.yaw_rate * dt

    def run(
        self, state: DriveState, seconds: float, dt: float = 0.02, **commands: object
    ) -> tuple[DriveState, WheelOutput]:
        """Periods with the same commands but a goal, which is sent once."""
        state, output = self.model.step(state, self.measure(**commands), dt)
        self.move(output, dt)
        commands.pop("goal", None)
        commands.pop("stop", None)
        for _ in range(round(seconds / dt) - 1):
            state, output = self.model.step(state, self.measure(**commands), dt)
            self.move(output, dt)
        return state, output


@pytest.fixture(scope="session")
def kinematic_machine() -> type[Machine]:
    """For machines of other drives."""
    return Machine


@pytest.fixture
def machine(model: WheelDrive) -> Callable[..., Machine]:
    """Makes machines."""
    return lambda **options: Machine(model, **options)
