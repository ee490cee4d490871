"""The plant of a scenario with the laws of the drive on it, in one process: the nodes without their messages."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin

from sojourn_config.scenario import load_scenario
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.drive_types import TwistCommand
from sojourn_physics.faults.acting import Acting, FaultyPlant, TimedFaults
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant
from wheel_drive import WheelDrive, WheelInput, WheelOutput

DT = 0.02


class DrivenPlant:
    """Measurements are the truth; the drive's answer moves the plant in the same period."""

    def __init__(self, scenario: str, overrides: Sequence[str] = ()) -> None:
        loaded = load_scenario(scenario, overrides)
        self.plant, self.state = build_plant(loaded)
        self.drive = WheelDrive(loaded.drive, loaded.steering)
        start = loaded.config.start
        self.drive_state = self.drive.initial_state(start.x, start.y, start.yaw)
        self._command = zeros_command(len(self.plant.joints.names), len(self.plant.loads))
        self._command.reference[0] = self.state.joints[0]
        wheels = loaded.machine.wheels
        self._wheels = self.plant.reference_rows([wheel.joint for wheel in wheels])
        self._steered = [i for i, wheel in enumerate(wheels) if wheel.steer_joint is not None]
        self._steering = self.plant.reference_rows([w.steer_joint for w in wheels if w.steer_joint is not None])
        self.faults = TimedFaults(FaultyPlant(self.plant), loaded.config.faults, loaded.config.seed)
        self.acting: Acting = ()
        self.efforts = np.zeros(len(self.plant.joints.names))
        self.contacts = np.zeros((len(self.plant.supports.names), 0))
        self.time = 0.0

    @property
    def position(self) -> tuple[float, float]:
        """True place in map [m]."""
        return float(self.state.configuration[0]), float(self.state.configuration[1])

    @property
    def yaw(self) -> float:
        """True heading [rad]."""
        x_axis = pin.Quaternion(self.state.configuration[3:7]).toRotationMatrix()[:, 0]
        return math.atan2(x_axis[1], x_axis[0])

    def period(self, goal: Goal | None = None, twist: PlanarTwist | None = None) -> WheelOutput:
        """One control period."""
        base = pin.Quaternion(self.state.configuration[3:7]).toRotationMatrix()
        columns = self.plant.joints.columns
        angles = np.zeros(len(self._wheels))
        angles[self._steered] = self.state.joints[0, self._steering]
        measured = WheelInput(
            wheel_positions=self.state.joints[0, self._wheels],
            wheel_rates=self.state.velocity[columns[self._wheels]],
            steer_angles=angles,
            wheel_efforts=self.efforts[self._wheels],
            gyro=tuple(self.state.velocity[3:6].tolist()),
            roll_pitch=(math.atan2(base[2, 1], base[2, 2]), math.asin(-base[2, 0])),
            twist=None if twist is None else TwistCommand(twist, 0.0),
            goal=goal,
        )
        self.drive_state, output = self.drive.step(self.drive_state, measured, DT)
        reference = self._command.reference
        reference[1, self._wheels] = output.wheel_rates
        reference[0, self._steering] = output.steer_angles[self._steered]
        reference[1, self._steering] = output.steer_rates[self._steered]
        self.time += DT
        self.acting = self.faults.at(self.acting, self.state, self.time)
        plant, command = self.faults.plant.on(self.acting, self._command)
        self.state, seen = step(plant, self.state, command)
        self.efforts, self.contacts = seen.efforts, seen.contacts
        return output

    def run(
        self,
        seconds: float,
        goal: Goal | None = None,
        twist: PlanarTwist | None = None,
        watch: Callable[["DrivenPlant", WheelOutput], None] | None = None,
    ) -> GoalOutcome | None:
        """Until the goal ends, or the time does."""
        for _ in range(round(seconds / DT)):
            output = self.period(goal, twist)
            goal = None
            if watch is not None:
                watch(self, output)
            if output.outcomes:
                return output.outcomes[-1]
        return None
