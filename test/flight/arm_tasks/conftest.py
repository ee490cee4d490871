"""The explorer on its ground with the laws of its arm in the loop: plant, sensors and tasks, without ROS."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_flight.arm.footing import Footing, FootingLoads
from sojourn_flight.arm.goals import ArmGoal, JointGoal
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.kinematics import inverse_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.state import ArmInput, ArmOutput
from sojourn_flight.arm.tasks import task_control
from sojourn_flight.arm.tasks.requests import TaskRequest, parse_task
from sojourn_flight.arm.tasks.task import ToolReading
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantOutput, PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_physics.sensors import joints, wrench
from sojourn_physics.sensors.joints import JointMeasurement, JointTruth
from sojourn_physics.sensors.wrench import WrenchSensorParams
from sojourn_plant.start import build_plant

DT = 0.02
TIP = "arm_tip"


@dataclass
class RoverArm:
    """A rover whose arm carries out tasks. What happened is in `log`, one row a period."""

    scenario: LoadedScenario
    model: PlantModel
    arm: ArmModel
    plant: PlantState
    sensors: Any
    tasks: task_control.TaskState
    output: PlantOutput | None = None
    report: task_control.TaskReport | None = None
    said: ArmOutput | None = None
    log: list[dict[str, Any]] = field(default_factory=list)
    has_wrist: bool = True
    loads: FootingLoads | None = None

    def wheel_loads(self, positions: FloatArray, gravity: FloatArray) -> FootingLoads:
        """What the flight side knows of the rover's stand."""
        params = self.scenario.arm
        footing = Footing(
            self.scenario.urdf_xml, self.scenario.machine, params.joint_names, params.base_link, params.tip_link
        )
        joints = dict(zip(self.model.joints.names, self.plant.joints[0], strict=True))
        return footing.loads(joints, positions, gravity)

    @property
    def pad(self) -> int:
        return self.model.supports.names.index(TIP)

    def rotation(self) -> FloatArray:
        """base_link to map, (3, 3)."""
        return np.array(pin.Quaternion(self.plant.configuration[3:7]).toRotationMatrix())

    def period(
        self, goal: ArmGoal | None = None, task: TaskRequest | None = None, jog: JogCommand | None = None
    ) -> None:
        """One control period."""
        model, params = self.model, self.scenario.arm
        columns = model.reference_rows(list(params.joint_names))
        efforts = np.zeros(len(model.joints.names)) if self.output is None else self.output.efforts
        tool = self.plant.tool
        of_tool = ([], []) if tool is None else ([tool.position], [tool.effort])
        truth = JointTruth(np.append(self.plant.joints[0], of_tool[0]), np.append(efforts, of_tool[1]))
        load = np.zeros(6) if self.output is None else self.output.wrist_wrench
        of_joints, of_wrist = self.sensors
        of_joints, measured = joints.step(of_joints, truth, DT)
        of_wrist, wrist = wrench.step(of_wrist, load)
        self.sensors = of_joints, of_wrist
        places = [self.sensors[0].layout.joint_names.index(name) for name in params.joint_names]
        gravity = self.rotation().T @ np.array([0.0, 0.0, -model.gravity])
        inputs = task_control.TaskInput(
            ArmInput(measured.position[places], measured.velocity[places], gravity, goal=goal),
            task,
            wrist if self.has_wrist and self.output is not None else None,
            measured.effort[places] if self.output is not None else None,
            self._reading(measured),
            self.loads,
            jog,
        )
        self.tasks, self.said, self.report = task_control.step(params, self.arm, self.tasks, inputs, DT)
        command = zeros_command(len(model.joints.names), len(model.loads))
        command.reference[0] = self.plant.joints[0]
        drives = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
        command.reference[0, drives] = 0.0
        command.reference[:, columns] = np.array([self.said.positions, self.said.velocities, self.said.efforts])
        if tool is not None:
            command = replace(command, tool=np.array(self.tasks.tool_command))
        self.plant, self.output = step(model, self.plant, command)
        self.log.append(self._row())

    def _reading(self, measured: JointMeasurement) -> ToolReading | None:
        names = self.sensors[0].layout.joint_names
        if TOOL_JOINT not in names:
            return None
        place = names.index(TOOL_JOINT)
        columns = (measured.position, measured.velocity, measured.effort)
        return ToolReading(*(float(column[place]) for column in columns))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.period()

    def settle(self, joints: FloatArray) -> None:
        """Put the arm there by a joint goal."""
        self.period(goal=JointGoal(self.scenario.arm.joint_names, tuple(float(q) for q in joints)))
        for _ in range(3000):
            self.period()
            if self.said is not None and self.said.status != "moving":
                break
        assert self.said is not None and self.said.status == "reached", self.said

    def over_ground(self, x: float, y: float, height: float) -> None:
        """The tip over the ground at (x, y) of base_link, the tool pointing down in the map."""
        down = self.rotation().T @ np.array([0.0, 0.0, -1.0])
        ground = self.ground_below(x, y)
        found = inverse_kinematics(
            self.scenario.arm, self.arm, ground - height * down, down, np.array(self.scenario.arm.named_poses["unfold"])
        )
        self.settle(found.solutions[0])

    def ground_below(self, x: float, y: float) -> FloatArray:
        """Point of the ground under (x, y) of base_link, in base_link (3,)."""
        rotation, origin = self.rotation(), self.plant.configuration[:3]
        z = -0.47
        for _ in range(20):
            there = origin + rotation @ np.array([x, y, z])
            z += (self.model.terrain.height(there[0], there[1]) - there[2]) / rotation[2, 2]
        return np.array([x, y, z])

    def task(self, name: str, seconds: float, **numbers: Any) -> task_control.TaskReport:
        """Carry out a task until it has ended, `seconds` at most."""
        self.period(task=parse_task(name, numbers))
        for _ in range(round(seconds / DT)):
            if self.report is None or self.report.doing.state != "moving":
                break
            self.period()
        assert self.report is not None, self.said
        return self.report

    def since(self, key: str, start: int) -> FloatArray:
        """A column of the log from a period on."""
        return np.array([row[key] for row in self.log[start:]])

    def _row(self) -> dict[str, Any]:
        assert self.output is not None
        data = self.model.data
        pin.forwardKinematics(self.model.multibody, data, self.plant.configuration)
        pads = self.model.supports.tables.pads.carried
        body, offset = pads.bodies[self.pad - pads.first], pads.offsets[self.pad - pads.first]
        place = np.array(data.oMi[int(body)].act(offset))
        row = {"force": self.output.contacts[self.pad, 6:9].copy(), "tip": place}
        row["efforts"] = self.output.efforts[self.model.reference_rows(list(self.scenario.arm.joint_names))]
        row["speed"] = float(np.abs(self.plant.velocity).max())
        row["phase"] = getattr(getattr(self.tasks.activity, "task", None), "phase", "")
        if self.report is not None:
            row["felt"] = self.report.doing.figures.get("contact_force_n", np.nan)
        return row


def _with_payload(urdf: str, mass: float) -> str:
    """A URDF whose arm carries a small body of a mass [kg] at its tip."""
    robot = ElementTree.fromstring(urdf)
    (tip,) = [link for link in robot.iter("link") if link.get("name") == "arm_tip_link"]
    inertial = ElementTree.SubElement(tip, "inertial")
    ElementTree.SubElement(inertial, "mass", value=str(mass))
    moments = {"ixx": "1e-4", "ixy": "0", "ixz": "0", "iyy": "1e-4", "iyz": "0", "izz": "1e-4"}
    ElementTree.SubElement(inertial, "inertia", moments)
    return ElementTree.tostring(robot, encoding="unicode")


@lru_cache(maxsize=8)
def _ready(overrides: tuple[str, ...], payload: float = 0.0) -> RoverArm:
    """A rover with its arm unfolded; its law knows nothing of the payload at the tip [kg]."""
    scenario = load_scenario("flat_drive", overrides)
    arm = build_arm_model(scenario.urdf_xml, scenario.arm)
    loaded = scenario.urdf.text if payload == 0.0 else _with_payload(scenario.urdf.text, payload)
    model, plant = build_plant(replace(scenario, urdf=replace(scenario.urdf, text=loaded)))
    names = (*model.joints.names, *(() if plant.tool is None else (TOOL_JOINT,)))
    angles = np.append(plant.joints[0], () if plant.tool is None else plant.tool.position)
    wrist = scenario.sensors.first(WrenchSensorParams)
    rest = JointTruth(angles, np.zeros(len(angles)))
    sensors = joints.initial_state(scenario.sensors.joint_groups, 3, names, rest), wrench.initial_state(wrist, 3)
    tasks = task_control.initial_state(scenario.arm, arm, scenario.tool)
    rover = RoverArm(scenario, model, arm, plant, sensors, tasks)
    rover.settle(np.array(scenario.arm.named_poses["unfold"]))
    return rover


@pytest.fixture
def rover_arm() -> Iterator[Callable[..., RoverArm]]:
    """Maker of rovers with their arm unfolded, by overrides of the scenario; each one a branch of its own."""

    def make(*overrides: str) -> RoverArm:
        ready = _ready(tuple(overrides))
        return replace(ready, plant=ready.plant.copy(), log=[])

    yield make


@pytest.fixture
def loaded_rover_arm() -> Iterator[Callable[[float], RoverArm]]:
    """The same, with a mass [kg] at the tip."""

    def make(payload: float) -> RoverArm:
        ready = _ready(("body=mars",), payload)
        return replace(ready, plant=ready.plant.copy(), log=[])

    yield make
