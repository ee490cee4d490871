"""Plant, sensors and drive of a scenario in one loop, without ROS: for measurements that need many runs.

The conversions are those of the nodes, so that the drive gets what it would get over the topics, to the last bit, but
for the power manager: all loads stay on. The drive goes the way that it is given: the camera serves its odometry, and
the handling of obstacles only where that is asked for. The arm holds its pose.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin

from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import Period
from sojourn_contract.clouds import points_of
from sojourn_contract.hazcam import TOPIC as HAZCAM
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_contract.stereo_pair import pair_place_of
from sojourn_contract.values import JointState, Odometry
from sojourn_drive.measurements import JointMeasurements
from sojourn_drive.stereo import StereoInput
from sojourn_drive.sun import SunSightings
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput, TwistCommand
from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.faults.acting import Acting, FaultyPlant, TimedFaults
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantOutput, PlantState
from sojourn_physics.plant.step import step as step_plant
from sojourn_plant.commands import Commands
from sojourn_plant.start import build_plant
from sojourn_sensors.app import SensorsApp


class ClosedLoop:
    """A run that is stepped by hand.

    Args:
        scenario: with its seed: that of the ground and of all sensors.
        placed: the plant and its first state; None to build them. avoids: whether obstacles are handled.
    """

    def __init__(
        self, scenario: LoadedScenario, placed: tuple[PlantModel, PlantState] | None = None, avoids: bool = False
    ) -> None:
        self.scenario = scenario
        self.plant, self.truth = build_plant(scenario) if placed is None else placed
        params = scenario.drive if avoids else scenario.drive.model_copy(update={"obstacles": None})
        self.drive = DriveModel(params, scenario.mobility(), hazard_camera_of(scenario), pair_place_of(scenario))
        self.drive.warm_up()
        start = scenario.config.start
        height = scenario.as_believed().start_height()
        self.drive_state = self.drive.initial_state(start.x, start.y, start.yaw, height)
        self.output: DriveOutput = self.drive.at_rest(self.drive_state)
        self.plant_output: PlantOutput | None = None
        """What the plant tells of the last period."""
        self.period = 0
        self._wheels = JointMeasurements(scenario.machine, self.drive.mobility.joints, scenario.urdf_xml)
        self._camera, self._sightings, self._sighted = self.drive.camera, SunSightings(scenario.as_believed()), 0
        self._stereo, self._seen = StereoInput(scenario), -1
        self._joint_names = (*self.plant.joints.names, *(() if self.plant.tool is None else (TOOL_JOINT,)))
        self._sensors = SensorsApp(scenario)
        self._sensing = self._sensors.initial_state()
        self._tilt_rates = (0.0, 0.0)
        self._faults = TimedFaults(FaultyPlant(self.plant), scenario.config.faults, scenario.config.seed)
        self._acting: Acting = ()
        self._commands = Commands(self.plant)
        self._held = self._commands.holding(self.truth.motor_angles)

    def step(
        self,
        goal: Goal | None = None,
        twist: PlanarTwist | None = None,
        change: Callable[[DriveInput], DriveInput] = lambda measured: measured,
    ) -> DriveOutput:
        """One control period; `goal` and `twist` come in it, and `change` is what becomes of the measurements."""
        self.period += 1
        stamp = self.period * stamps.CONTROL_PERIOD_NS
        measured = self._measure(stamp, goal, None if twist is None else TwistCommand(twist, 0.0))
        if measured.felt.gyro is not None:
            self._tilt_rates = measured.felt.gyro[:2]
        self.drive_state, self.output = self.drive.step(self.drive_state, change(measured), stamps.CONTROL_PERIOD_S)
        self._move(stamp)
        return self.output

    def _move(self, stamp: int) -> None:
        """The plant's part of the period that ends at `stamp` [ns]."""
        self._held = self._commands.take(self._held, {"/drive_command": self._wheels.command(stamp, self.output)})
        asked = self._commands.at(self._held, stamp)
        self._acting = self._faults.at(self._acting, self.truth, stamps.seconds(stamp))
        plant, command = self._faults.plant.on(self._acting, asked)
        self.truth, self.plant_output = step_plant(plant, self.truth, command)

    @property
    def true_pose(self) -> tuple[float, float, float]:
        """x, y [m] and heading [rad] of base_link in map."""
        x_axis = pin.Quaternion(self.truth.configuration[3:7]).toRotationMatrix()[:, 0]
        x, y = self.truth.configuration[:2]
        return float(x), float(y), float(np.arctan2(x_axis[1], x_axis[0]))

    @property
    def tilt_rates(self) -> tuple[float, float]:
        """Angular velocity of base_link about its x and y axes, as last measured [rad/s]."""
        return self._tilt_rates

    @property
    def true_slip(self) -> FloatArray:
        """Slip of each wheel in the last period, counted on its grouser tips, as the drive does [-].

        The plant counts it on the rim.
        """
        wheels = self.scenario.machine.rolling
        if self.plant_output is None:
            return np.zeros(len(wheels))
        tips = np.array([wheel.shear_radius / wheel.radius for wheel in wheels])
        slips = self.plant_output.contacts[: len(wheels), ReportColumn.SLIP_RATIO]
        over_rim = np.where(slips >= 0.0, 1.0 - slips, 1.0 / np.maximum(1.0 + slips, 1e-3))  # ground over rim
        over_tips = over_rim / tips
        return np.asarray(np.where(over_tips <= 1.0, 1.0 - over_tips, 1.0 / np.maximum(over_tips, 1.0) - 1.0))

    def _measure(self, stamp: int, goal: Goal | None, twist: TwistCommand | None) -> DriveInput:
        place, motion = self.truth.configuration, self.truth.velocity
        odometry = Odometry(stamp, "map", "base_link", place[:3], place[3:7], motion[:3], motion[3:6])
        efforts = self.plant.efforts if self.plant_output is None else self.plant_output.efforts
        position, effort = self._with_tool(self.truth.joints[0], 0), self._with_tool(efforts, 1)
        joints = JointState(stamp, self._joint_names, position, np.zeros_like(position), effort)
        inputs = {"/truth/odom": odometry, "/truth/joint_states": joints}
        self._sensing, answer = self._sensors.step(self._sensing, Period(stamp, inputs))
        for topic, reason in answer.refusals:
            raise CommandError(f"the sensors refuse {topic}: {reason}")
        said = dict(answer.messages)
        sun = None
        if "/sun_direction" in said:
            sun, self._sighted = self._sightings.sighting(stamp, said["/sun_direction"], self._sighted)
        measured = self._wheels.drive_input(said["/joint_states"], said["/imu/data"])
        measured = replace(measured, sun=sun, twist=twist, goal=goal)
        if self._camera is not None and HAZCAM in said:
            measured = replace(measured, cloud=points_of(HAZCAM, said[HAZCAM]).astype(np.float64))
        images, self._seen = self._stereo.images(stamp, said, self._seen)
        return measured if images is None else replace(measured, images=images)

    def _with_tool(self, of_joints: FloatArray, place: int) -> FloatArray:
        """What the sensors measure of the joints and, at the end, of the tool: position (0) or effort (1)."""
        tool = self.truth.tool
        return of_joints if tool is None else np.append(of_joints, (tool.position, tool.effort)[place])
