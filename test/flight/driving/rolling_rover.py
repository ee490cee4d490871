"""A drive on real ground without a plant: the wheels obey, and the body settles on the ground under them.

What is left out is what needs the plant: soil, suspension, motors, and with them the errors of odometry. What is in:
the whole drive, the camera with its noise, the tilt of the ground. So minutes of driving take seconds.
"""

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_flight.mobility.wheel_twist import twist_from_wheels
from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams, HazcamView
from wheel_drive import WheelDrive, WheelInput, WheelOutput, with_mobility

DT = 0.1
LOOK_EVERY = 10


@dataclass
class RollingRover:
    """The rover of a scenario. Its odometry is believed, but for height and tilt, which are those of the ground."""

    scenario: LoadedScenario
    track: list[tuple[float, float, float]] = field(default_factory=list)
    """x, y, yaw at each look."""
    ways: list[FloatArray] = field(default_factory=list)
    """Places along each way round that was taken, shape (n, 2) [m]."""
    worst_tilt: float = 0.0
    """[rad]"""
    reversed: float = 0.0
    """Way driven backwards [m]."""
    dead: tuple[str, ...] = ()
    """Wheels that do not turn; they do not hold the rover either."""

    def __post_init__(self) -> None:
        scenario = self.scenario
        self.ground = scenario.height_field()
        camera = scenario.sensors.first(HazcamParams)
        assert camera is not None
        self.camera = hazcam.hazcam_on(camera, scenario.urdf_xml)
        self.noise = hazcam.initial_state(self.camera, scenario.config.seed)
        # the ground gives no slip here
        firm = {"mean_slip": 0.0, "slip_per_grade": 0.0, "side_slip_per_grade": 0.0, "turn_drift_per_grade": 0.0}
        firm_ground = scenario.drive.odometry.model_copy(update=firm)
        params = with_mobility(scenario.drive, slip=None)
        params = params.model_copy(update={"odometry": firm_ground, "terrain_match": None})
        self.model = WheelDrive(params, scenario.steering, hazard_camera_of(scenario))
        start = scenario.config.start
        self.state = self.model.initial_state(start.x, start.y, start.yaw, scenario.as_believed().start_height())
        self.wheels = np.array([(wheel.x, wheel.y) for wheel in scenario.steering.wheels])
        self.output: WheelOutput = self.model.at_rest(self.state)
        self.positions = np.zeros(len(self.wheels))
        self.rate = 0.0
        self.period = 0

    @property
    def place(self) -> tuple[float, float, float]:
        """x, y [m], yaw [rad]."""
        odometry = self.state.odometry
        return odometry.x, odometry.y, odometry.yaw

    @property
    def changes_of_mind(self) -> int:
        """How often the side has changed on which the ways pass the straight line to the goal."""
        goal, start = self.ways[0][-1], np.array(self.track[0][:2])
        along = (goal - start) / np.linalg.norm(goal - start)
        sides = []
        for way in self.ways:
            off = (way - start) @ np.array([-along[1], along[0]])
            sides.append(math.copysign(1.0, off[int(np.argmax(np.abs(off)))]))
        return sum(one != other for one, other in itertools.pairwise(sides))

    def run(self, seconds: float, goal: Goal) -> GoalOutcome | None:
        """Drive until the goal ends, or for a time."""
        wanted: Goal | None = goal
        for _ in range(round(seconds / DT)):
            outcomes = self._step(wanted)
            wanted = None
            if outcomes:
                return outcomes[0]
        return None

    def felt(self, inputs: WheelInput) -> WheelInput:
        """The measurements with those that the ground makes; for rovers on ground that gives way."""
        return inputs

    def _settled(self) -> tuple[float, float, float]:
        """Height of the ground under base_link [m], roll and pitch [rad] of the plane through the wheels' places."""
        x, y, yaw = self.place
        cosine, sine = math.cos(yaw), math.sin(yaw)
        heights = np.array([self.ground.height(x + cosine * a - sine * b, y + sine * a + cosine * b)
                            for a, b in self.wheels.tolist()])  # fmt: skip
        plane = np.stack([np.ones(len(heights)), *self.wheels.T], axis=1)
        level, ahead, left = np.linalg.lstsq(plane, heights, rcond=None)[0]
        return float(level), math.atan(left * math.cos(math.atan(ahead))), -math.atan(ahead)

    def _step(self, goal: Goal | None) -> tuple[GoalOutcome, ...]:
        self.period += 1
        level, roll, pitch = self._settled()
        self.worst_tilt = max(self.worst_tilt, math.acos(math.cos(roll) * math.cos(pitch)))
        cloud: FloatArray | None = None
        if self.period % LOOK_EVERY == 0:
            x, y, yaw = self.place
            self.track.append(self.place)
            rotation = rotation_of(roll, pitch, yaw)
            ride = self.model.params.obstacles.outline.ride_height if self.model.params.obstacles else 0.0
            base = np.array([x, y, level]) + ride * rotation[:, 2]
            self.noise, points = hazcam.step(self.camera, self.noise, HazcamView(self.ground), base, rotation)
            cloud = points.astype(np.float64)
        rates = np.where([name in self.dead for name in self.model.geometry.names], 0.0, self.output.wheel_rates)
        self.positions = self.positions + rates * DT
        before = self.state
        inputs = WheelInput(
            self.positions,
            rates,
            self.output.steer_angles,
            gyro=(0.0, 0.0, self.rate),
            roll_pitch=(roll, pitch),
            cloud=cloud,
            goal=goal,
        )
        self.state, self.output = self.model.step(self.state, self.felt(inputs), DT)
        odometry = self.state.odometry
        self.rate = self._wheel_rate()
        if odometry.v_x < -0.005:
            self.reversed += -odometry.v_x * DT
        was, now = before.avoidance, self.state.avoidance
        if was is not None and now is not None and now.detours > was.detours and self.state.follower is not None:
            path = self.state.follower.path
            self.ways.append(np.concatenate([leg.samples[::4, 1:3] for leg in path.legs]))
        return self.output.outcomes

    def _wheel_rate(self) -> float:
        """Yaw rate that the commanded wheels make [rad/s]."""
        return float(twist_from_wheels(self.model.table, self.output.wheel_rates, self.output.steer_angles)[2])
