"""The sensors without ROS: truth in, measurements out, from the emulators of `sojourn_physics.sensors`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import NOTHING, Answer, App, Period
from sojourn_contract.barrier import is_due
from sojourn_contract.clouds import point_cloud
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import wrench_stamped
from sojourn_contract.topics import topic
from sojourn_contract.values import JointState, Odometry
from sojourn_machine.errors import MachineError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import suite
from sojourn_physics.sensors.noise import NoiseStream
from sojourn_physics.sensors.suite import SensorMeasurements, SensorSuiteState, SensorTruth
from sojourn_physics.sensors.sun_sensor import SunSensorState
from sojourn_sensors.motion import ImuMotion
from sojourn_sensors.readings import bus_message, dead_imu, imu_message, joints_message
from sojourn_sensors.sun import SunReadings
from sojourn_sensors.supply import LOADS, without_power
from sojourn_sensors.truth import TruthBefore, TruthReader
from sojourn_sensors.view import NO_POINTS, HazardView

STORE = "battery"
BUS, SUN, CLOUD = topic("/bus/state"), topic("/sun_direction"), topic("/hazcam/points")


@dataclass(frozen=True, slots=True)
class BasePose:
    """True place of base_link in map: (3,) [m], quaternion x y z w."""

    position: FloatArray
    orientation: FloatArray


@dataclass(frozen=True, slots=True)
class SensorsState:
    """What the role remembers. Parts are None until the first truth says which joints there are and how it stands."""

    sun: SunSensorState | None
    camera: NoiseStream | None
    sensors: SensorSuiteState | None = None
    measured: SensorMeasurements | None = None
    """The last ones, which are told again where the truth cannot be used."""
    pose: BasePose | None = None
    truth: TruthBefore = field(default_factory=TruthBefore)
    dead: frozenset[str] = frozenset()
    """Sensors without power."""
    measured_at: int = 0
    """Stamp of the last truth that could be used [ns]; zero where it is not known."""


@dataclass(frozen=True, slots=True)
class _Seldom:
    """What is measured less than once a period; None where it is not due."""

    sun: FloatArray | None
    cloud: NDArray[np.float32] | None


class SensorsApp(App[SensorsState]):
    """Role sensors."""

    role = "sensors"

    def __init__(self, scenario: LoadedScenario) -> None:
        self.params = scenario.sensors
        self._seed = scenario.config.seed
        self._gravity = scenario.gravity
        self._motion = ImuMotion(scenario.urdf_xml, scenario.gravity)
        self._truth = TruthReader(self._motion)
        self._sun = SunReadings(scenario)
        self._view = HazardView(scenario)
        self._wrist_frame = scenario.machine.wrench_sensor_link or ""

    def warm_up(self) -> None:
        """Those of the suite and of the camera."""
        suite.warm_up(self.params, self._gravity)
        self._view.warm_up()

    def initial_state(self) -> SensorsState:
        """Before the first truth."""
        return SensorsState(self._sun.initial_state(), self._view.initial_state())

    def on_new_time(self, state: SensorsState) -> SensorsState:
        """The time since the last truth is not known."""
        return replace(state, measured_at=0)

    def step(self, state: SensorsState, period: Period) -> tuple[SensorsState, Answer]:
        """Measure the truth of this period."""
        stamp, inputs = period.stamp, period.inputs
        loads = inputs.get(LOADS)
        if loads is not None:
            state = replace(state, dead=without_power(self.params.powered_by, state.dead, loads))
        state, refusals = self._measure(state, stamp, inputs)
        odometry = inputs["/truth/odom"]
        if odometry is not None and state.measured is not None:
            state = replace(state, pose=BasePose(odometry.position, odometry.orientation))
        if state.measured is None or state.pose is None:  # nothing has been measured yet
            return state, Answer(refusals=refusals) if refusals else NOTHING
        measured, supplied = state.measured, inputs.get("/truth/electrical") is not None
        state, seldom = self._observe(state, state.pose, stamp)
        return state, Answer(self._messages(state, measured, seldom, stamp, supplied), refusals)

    def _measure(
        self, state: SensorsState, stamp: int, inputs: Mapping[str, Any]
    ) -> tuple[SensorsState, list[tuple[str, Exception]]]:
        """What the sensors say of a period; where its truth cannot be used what they said last, if anything."""
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        if odometry is None or joints is None:  # refused on arrival
            return state, []
        dt = (stamp - state.measured_at) * 1e-9 if state.measured_at else stamps.CONTROL_PERIOD_S
        try:
            before, truth = self._truth.read(state.truth, inputs, dt)
            sensors = self._first(odometry, joints, truth) if state.sensors is None else state.sensors
            sensors, measured = suite.step(self.params, sensors, truth, dt)
        except (MachineError, RefusedMessageError) as error:
            return state, [("/truth/joint_states", error)]
        return replace(state, sensors=sensors, measured=measured, truth=before, measured_at=stamp), []

    def _first(self, odometry: Odometry, joints: JointState, truth: SensorTruth) -> SensorSuiteState:
        return suite.initial_state(
            self.params,
            self._seed,
            joints.names,
            truth.joint_position,
            (STORE,),
            self._motion.orientation_imu_in_map(odometry.orientation),
            self._gravity,
            truth.motor_position,
        )

    def _observe(self, state: SensorsState, pose: BasePose, stamp: int) -> tuple[SensorsState, _Seldom]:
        """The Sun and the ground ahead, where they are due."""
        period, sun, cloud = stamp // stamps.CONTROL_PERIOD_NS, None, None
        if is_due(SUN, period):
            seen_by, sun = self._sun.reading(state.sun, stamp, pose.orientation)
            state, sun = replace(state, sun=seen_by), sun if "sun" not in state.dead else np.zeros(3)
        if is_due(CLOUD, period):
            cloud = NO_POINTS
            if "hazcam" not in state.dead:
                camera, cloud = self._view.observe(state.camera, pose.position, pose.orientation)
                state = replace(state, camera=camera)
        return state, _Seldom(sun, cloud)

    def _messages(
        self, state: SensorsState, measured: SensorMeasurements, seldom: _Seldom, stamp: int, supplied: bool
    ) -> Iterator[tuple[str, Any]]:
        if supplied and is_due(BUS, stamp // stamps.CONTROL_PERIOD_NS):
            yield "/bus/state", bus_message(stamp, measured)
        if state.sensors is not None:
            yield "/joint_states", joints_message(stamp, state.sensors.layout.joint_names, measured)
        wrist = None if "wrist" in state.dead else measured.wrist_wrench
        yield "/wrist/wrench", wrench_stamped(stamp, self._wrist_frame, wrist)
        if seldom.sun is not None:
            yield "/sun_direction", self._sun.message(stamp, seldom.sun)
        imu = dead_imu(measured.imu) if "imu" in state.dead else measured.imu
        yield "/imu/data", imu_message(stamp, imu)
        if seldom.cloud is not None:
            yield "/hazcam/points", point_cloud(stamp, "base_link", seldom.cloud)
