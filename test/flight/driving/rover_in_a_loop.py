"""Plant, sensors and drive of a scenario in one process, without ROS: the loop of the nodes, period by period."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.drive_types import TwistCommand
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step as step_plant
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams, HazcamView
from sojourn_plant.start import build_plant
from wheel_drive import WheelDrive, WheelInput, WheelOutput

DT = 0.02
LOOK_EVERY = 50


@dataclass
class Loop:
    """A rover on its ground. Joints, gyro and tilt are measured without error; the camera has its noise."""

    scenario: LoadedScenario
    outcomes: list[GoalOutcome] = field(default_factory=list)
    track: list[tuple[float, float, float]] = field(default_factory=list)
    """True x, y, yaw at every look of the camera."""
    touched: set[str] = field(default_factory=set)
    """Pads that have met the ground."""
    worst_tilt: float = 0.0
    """[rad]"""
    period: int = 0
    output: WheelOutput | None = None

    def __post_init__(self) -> None:
        scenario = self.scenario
        self.plant, self.state = build_plant(scenario)
        camera = scenario.sensors.first(HazcamParams)
        self.camera = None if camera is None else hazcam.hazcam_on(camera, scenario.urdf_xml)
        self.noise = None if self.camera is None else hazcam.initial_state(self.camera, scenario.config.seed)
        self.model = WheelDrive(scenario.drive, scenario.steering, hazard_camera_of(scenario))
        start = scenario.config.start
        self.drive = self.model.initial_state(start.x, start.y, start.yaw, scenario.as_believed().start_height())
        wheels = scenario.machine.wheels
        self._wheels = self.plant.reference_rows([wheel.joint for wheel in wheels])
        self._steered = [place for place, wheel in enumerate(wheels) if wheel.steer_joint is not None]
        self._steers = self.plant.reference_rows([wheel.steer_joint for wheel in wheels if wheel.steer_joint])
        self.command = zeros_command(len(self.plant.joints.names), len(self.plant.loads))
        self.command.reference[0] = self.state.joints[0]
        self._names = self.plant.supports.names
        self._rates = np.zeros(len(self.plant.joints.names))

    @property
    def place(self) -> NDArray[np.float64]:
        """True position of base_link in map [m]."""
        found: NDArray[np.float64] = self.state.configuration[:3]
        return found

    def run(self, seconds: float, goal: Goal | None = None, twist: Any = None) -> list[GoalOutcome]:
        """Drive until a goal ends, or for a time; returns what has ended."""
        found: list[GoalOutcome] = []
        for _ in range(round(seconds / DT)):
            found += self._step(goal, twist)
            goal = None
            if found:
                break
        self.outcomes += found
        return found

    def _step(self, goal: Goal | None, twist: Any) -> list[GoalOutcome]:
        self.period += 1
        self.state, seen = step_plant(self.plant, self.state, self.command)
        self._note(seen.contacts)
        quaternion = self.state.configuration[3:7]
        rotation = pin.Quaternion(*(float(quaternion[i]) for i in (3, 0, 1, 2))).toRotationMatrix()
        roll, pitch = math.atan2(rotation[2, 1], rotation[2, 2]), math.asin(-rotation[2, 0])
        self.worst_tilt = max(self.worst_tilt, math.acos(min(rotation[2, 2], 1.0)))
        cloud = None
        if self.camera is not None and self.noise is not None and self.period % LOOK_EVERY == 0:
            self.noise, points = hazcam.step(
                self.camera, self.noise, HazcamView(self.plant.terrain), self.place.copy(), rotation
            )
            cloud = points.astype(np.float64)
            self.track.append((float(self.place[0]), float(self.place[1]), math.atan2(rotation[1, 0], rotation[0, 0])))
        angles = np.zeros(len(self._wheels))
        angles[self._steered] = self.state.joints[0, self._steers]
        gyro = self.state.velocity[3:6]
        columns = self.plant.joints.columns
        inputs = WheelInput(
            self.state.joints[0, self._wheels].copy(),
            self.state.velocity[columns[self._wheels]].copy(),
            angles,
            gyro=(float(gyro[0]), float(gyro[1]), float(gyro[2])),
            roll_pitch=(roll, pitch),
            goal=goal,
            twist=None if twist is None else TwistCommand(twist, 0.0),
        )
        self.drive, self.output = self.model.step(self.drive, replace(inputs, cloud=cloud), DT)
        self.command.reference[1, self._wheels] = self.output.wheel_rates
        self.command.reference[0, self._steers] = self.output.steer_angles[self._steered]
        self.command.reference[1, self._steers] = self.output.steer_rates[self._steered]
        return list(self.output.outcomes)

    def _note(self, contacts: NDArray[np.float64]) -> None:
        forces = np.abs(contacts[:, 6:9]).sum(axis=1)
        first = len(self.plant.wheel_names)
        self.touched |= {name for name, force in zip(self._names[first:], forces[first:], strict=True) if force > 0.0}
