"""Everything that a rover on a body needs, read from its files and checked together."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from sojourn_config.arm_config import ArmConfig
from sojourn_config.carrying_checks import carrying_problems
from sojourn_config.errors import MISSING, ConfigError, Problem, single
from sojourn_config.load import validate
from sojourn_config.machine_checks import ground_problems, machine_problems, steering_geometry, with_drive_data
from sojourn_config.mounting import Machine, join, lent, mount_problems
from sojourn_config.overrides import override_document
from sojourn_config.paths import SUFFIX, resolve, resolve_urdf
from sojourn_config.rover import RoverConfig
from sojourn_config.tool_config import ToolSet, pad_problem, tool_ground_problems, with_tool
from sojourn_config.urdf import UrdfSummary, parse_urdf, read_urdf
from sojourn_config.yaml_file import YamlDocument, asking_folders, dotted, read_yaml
from sojourn_flight.arm.dh import DhTable
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.power_manager.params import PowerLawParams, PowerManagerParams
from sojourn_flight.supervision.params import DriveParams, SteeringGeometryParams
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.loads import BusParams
from sojourn_machine.tools import ToolParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.sensors.params import SensorSuiteParams
from sojourn_physics.soil.params import SoilParams

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True, slots=True, eq=False)
class Driving:
    """What the drive node has of a machine with wheels: its set, and the wheels as it sees them."""

    drive: DriveParams
    steering: SteeringGeometryParams


@dataclass(frozen=True, slots=True, eq=False)
class Bundle:
    """The parameter sets of a run.

    Args:
        rover: wheels, pads, drives, couplings (also the plant's MachineParams), those of its arm among them.
        urdf: the machine's URDF, with the arm that is mounted on it; `urdf.text` is the XML.
        body: planet or moon.
        soil, rock_soil: default soil of the ground, and soil of its rocks.
        extra_soils: soils of patches and of the soil raster.
        battery, bus: energy store and its loads.
        power_manager: what the power manager believes and its law.
        sensors: set of the sensors' node.
        arm: set of the arm node, None for a rover without one; rotor inertia and friction that its file leaves out
            are filled in from the rover's drives.
        tool: at the end of the arm, None where there is none.
        driving: set of the drive node and wheels from URDF and rover; None for a machine that stands fast.
        files: text of every file that was read, by name; the scenario's is first.
    """

    rover: RoverConfig
    urdf: UrdfSummary
    body: BodyParams
    soil: SoilParams
    rock_soil: SoilParams
    extra_soils: tuple[SoilParams, ...]
    battery: BatteryParams
    bus: BusParams
    power_manager: PowerManagerParams
    sensors: SensorSuiteParams
    arm: ArmConfig | None
    tool: ToolParams | None
    driving: Driving | None
    files: dict[str, str]

    @property
    def urdf_xml(self) -> str:
        """The URDF as text."""
        return self.urdf.text

    @property
    def soils(self) -> dict[str, SoilParams]:
        """The soils of the ground by name."""
        return {soil.name: soil for soil in (*self.extra_soils, self.rock_soil, self.soil)}

    def carried_arm(self) -> ArmConfig:
        """The set of the arm. Raises ConfigError for a rover without one."""
        if self.arm is None:
            raise single(next(iter(self.files)), "rover", self.urdf.file, "this rover has no arm")
        return self.arm

    @property
    def drive(self) -> DriveParams:
        """The set of the drive node. Raises ConfigError for a machine that stands fast."""
        return self._driving().drive

    @property
    def steering(self) -> SteeringGeometryParams:
        """The wheels as the drive node sees them. Raises ConfigError for a machine that stands fast."""
        return self._driving().steering

    def _driving(self) -> Driving:
        if self.driving is None:
            raise single(self.urdf.file, "", MISSING, "this machine stands fast: it does not drive")
        return self.driving

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm; none where there is no arm."""
        return () if self.arm is None else self.arm.joint_names

    def arm_pose(self, name: str) -> dict[str, float]:
        """Angles of the arm's joints in a named pose [rad]; none where there is no arm, or no such pose."""
        positions = () if self.arm is None else self.arm.named_poses.get(name, ())
        return dict(zip(self.arm_joints, positions, strict=False))

    @property
    def gravity(self) -> float:
        """Surface gravity [m/s2]."""
        return self.body.surface_gravity

    def fields(self) -> dict[str, Any]:
        """The fields by name, to build a larger bundle from."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(Bundle)}


class BundleReader:
    """Reads the files of a scenario one after the other and collects the problems of all of them.

    Args:
        scenario: what names the files. path: its file, None for a command line.
        overrides: `KEY=VALUE` texts by what they are for.
    """

    def __init__(self, scenario: YamlDocument, path: Path | None, overrides: dict[str, list[str]]) -> None:
        self.problems: list[Problem] = []
        self.files: dict[str, str] = {} if path is None else {scenario.file: path.read_text(encoding="utf-8")}
        self._scenario = scenario
        self._path = path or Path(scenario.file)
        self._overrides = overrides
        self._soils: dict[str, YamlDocument] = {}

    def read(
        self,
        rover: str,
        body: str,
        soil: str,
        rock_soil: str,
        extra_soils: Sequence[str] = (),
        mounted: str | None = None,
    ) -> Bundle | None:
        """All that a scenario names, or None with the reasons in `problems`. `mounted`: a tool, not the rover's own."""
        here = (self._scenario, self._path)
        found_body = self._named("bodies", body, "body", BodyParams, here)
        found_soil = self._named("soils", soil, "soil", SoilParams, here)
        found_rock = self._named("soils", rock_soil, "rock_soil", SoilParams, here)
        found_extra = [self._named("soils", name, "terrain", SoilParams, here) for name in extra_soils]
        named = self._load("rovers", rover, "rover", RoverConfig, here)
        if named is None:
            return None
        config, document, path = named
        there = (document, path)
        urdf = self._urdf(config.urdf, document, path)
        battery = self._load("power", config.battery, "battery", BatteryParams, there)
        bus = self._load("power", config.loads, "loads", BusParams, there)
        law = self._load("power", config.power_manager, "power_manager", PowerLawParams, there)
        sensors = self._load("sensors", config.sensors, "sensors", SensorSuiteParams, there)
        arm = self._arm(rover, config.arm, there)
        tool = self._tool(config, mounted, here, there)
        drive = self._driving(rover, config.drive, there)
        if urdf is None or battery is None or bus is None or law is None or sensors is None:
            return None
        if (
            (config.arm is not None and arm is None)
            or (tool is None and (mounted or config.tool))
            or (config.drive is not None and drive is None)
            or found_body is None
            or found_soil is None
            or found_rock is None
        ):
            return None
        extra = tuple(found for found in found_extra if found is not None)
        if len(extra) < len(found_extra):
            return None
        documents = {"rover": document, "sensors": sensors[1]}
        documents |= {role: found[1] for role, found in (("arm", arm), ("drive", drive)) if found is not None}
        grounds = {ground.name: ground for ground in (found_soil, found_rock, *extra)}
        for ground in grounds.values():
            self.problems += ground_problems(config, ground, self._soils[ground.name])
            self.problems += tool_ground_problems(tool and tool[0], ground, self._soils[ground.name])
        alone = Machine(config, urdf, bus[0], law[0], sensors[0], arm and arm[0])
        machine = self._with_arm(alone, documents, arm[2] if arm else path)
        if machine is None:
            return None
        found = machine_problems(
            machine.rover, urdf, machine.urdf, machine.bus, machine.sensors, machine.arm, drive and drive[0], documents
        )
        misplaced = tool and pad_problem(machine.rover, *tool[:2])
        found += [misplaced] if misplaced else []
        found = found or list(
            carrying_problems(
                machine.rover, machine.urdf, machine.arm, found_body.surface_gravity, battery[0], documents
            )
        )
        if found:
            self.problems += found
            return None
        return Bundle(
            rover=machine.rover,
            urdf=machine.urdf,
            body=found_body,
            soil=found_soil,
            rock_soil=found_rock,
            extra_soils=extra,
            battery=battery[0],
            bus=machine.bus,
            power_manager=PowerManagerParams(battery=battery[0], loads=machine.bus.loads, law=machine.law),
            sensors=machine.sensors if tool is None else with_tool(machine.sensors, tool[0]),
            arm=machine.arm and with_drive_data(machine.arm, machine.rover),
            tool=tool and tool[0].tool,
            driving=None if drive is None else Driving(drive[0], steering_geometry(machine.rover, machine.urdf)),
            files=self.files,
        )

    def _with_arm(self, machine: Machine, documents: Mapping[str, YamlDocument], arm_path: Path) -> Machine | None:
        """The machine joined with its arm; None with the reason in `problems`."""
        arm, arm_urdf = machine.arm, None
        if arm is not None and machine.rover.arm_mount is not None and (arm.urdf or arm.of_rover):
            asked = (documents["arm"], arm_path)
            lender = None if arm.of_rover is None else self._lender(arm.of_rover, asked)
            if lender is not None:
                machine = dataclasses.replace(machine, arm=lent(arm, lender))
                arm_urdf = lender.urdf
            if arm.urdf is not None:
                arm_urdf = self._urdf(arm.urdf, *asked)
            if arm_urdf is None:
                return None
        problems = list(mount_problems(machine, arm_urdf, documents))
        if problems:
            self.problems += problems
            return None
        try:
            return join(machine, arm_urdf)
        except ConfigError as error:
            self.problems += error.problems
            return None

    def _lender(self, rover: str, asked: tuple[YamlDocument, Path]) -> Machine | None:
        """A rover whose arm is put on another machine; None with the reason in `problems`."""
        found = self._load("rovers", rover, "of_rover", RoverConfig, asked)
        if found is None:
            return None
        config, document, path = found
        there = (document, path)
        urdf = self._urdf(config.urdf, document, path)
        bus = self._load("power", config.loads, "of_rover.loads", BusParams, there)
        law = self._load("power", config.power_manager, "of_rover.power_manager", PowerLawParams, there)
        sensors = self._load("sensors", config.sensors, "of_rover.sensors", SensorSuiteParams, there)
        if urdf is None or bus is None or law is None or sensors is None:
            return None
        return Machine(config, urdf, bus[0], law[0], sensors[0], None)

    def _arm(
        self, rover: str, name: str | None, asked: tuple[YamlDocument, Path]
    ) -> tuple[ArmConfig, YamlDocument, Path] | None:
        """The set of the arm; None where the rover has none, or with the reason in `problems`."""
        if name is not None:
            return self._load("arms", name, "arm", ArmConfig, asked)
        for text in self._overrides.get("arm", ()):
            self.problems.append(Problem(f"--set arm.{text}", "", "", f"the rover {rover} has no arm"))
        return None

    def _tool(
        self,
        config: RoverConfig,
        mounted: str | None,
        scenario: tuple[YamlDocument, Path],
        rover: tuple[YamlDocument, Path],
    ) -> tuple[ToolSet, YamlDocument, Path] | None:
        """The set of the tool; None where the arm has none, or with the reason in `problems`."""
        name, asked = (mounted, scenario) if mounted else (config.tool, rover)
        if name is None:
            for text in self._overrides.get("tool", ()):
                self.problems.append(Problem(f"--set tool.{text}", "", "", "the arm has no tool"))
            return None
        if config.arm is None:
            self.problems.append(asked[0].problem(("tool",), name, f"the machine {config.urdf} has no arm"))
            return None
        return self._load("tools", name, "tool", ToolSet, asked)

    def _driving(
        self, rover: str, name: str | None, asked: tuple[YamlDocument, Path]
    ) -> tuple[DriveParams, YamlDocument, Path] | None:
        """The set of the drive node; None where the machine stands fast, or with the reason in `problems`."""
        if name is not None:
            return self._load("nodes", name, "drive", DriveParams, asked)
        for text in self._overrides.get("drive", ()):
            self.problems.append(Problem(f"--set drive.{text}", "", "", f"the machine {rover} does not drive"))
        return None

    def _load(
        self, kind: str, name: str, key: str, model: type[Model], asked: tuple[YamlDocument, Path]
    ) -> tuple[Model, YamlDocument, Path] | None:
        """The set with its document and path; None with the reason in `problems`."""
        asked_document, asked_path = asked
        try:
            folders = asking_folders(asked_document, (key,), asked_path.parent)
            path = resolve(kind, name, (asked_document.file, key), folders)
            plain = read_yaml(path)
            self.files[plain.file] = path.read_text(encoding="utf-8")
            document = override_document(plain, self._overrides.get(key, ()))
            return validate(document, model), document, path
        except ConfigError as error:
            self.problems += _with_line(error.problems, asked_document, key)
            return None

    def _named(
        self, kind: str, name: str, key: str, model: type[Model], asked: tuple[YamlDocument, Path]
    ) -> Model | None:
        """A set that carries its own name, which must be that of its file."""
        loaded = self._load(kind, name, key, model, asked)
        if loaded is None:
            return None
        params, document, path = loaded
        own_name = getattr(params, "name", path.stem)
        if own_name != path.stem:
            allowed = f"allowed is the name of the file, {path.stem}"
            self.problems.append(document.problem(("name",), own_name, allowed))
            return None
        if kind == "soils":
            self._soils[path.stem] = document
        return params

    def _urdf(self, name: str, document: YamlDocument, path: Path) -> UrdfSummary | None:
        try:
            urdf_path = resolve_urdf(name, (document.file, "urdf"), path.parent)
            if urdf_path.suffix == SUFFIX:
                return self._urdf_of_table(urdf_path)
            urdf = read_urdf(urdf_path)
        except ConfigError as error:
            self.problems += _with_line(error.problems, document, "urdf")
            return None
        self.files[urdf.file] = urdf.text
        return urdf

    def _urdf_of_table(self, path: Path) -> UrdfSummary:
        """The URDF that a Denavit-Hartenberg table comes to. Raises ConfigError."""
        table = read_yaml(path)
        self.files[table.file] = path.read_text(encoding="utf-8")
        return parse_urdf(urdf_from_dh(validate(table, DhTable), table.file), table.file)


def read_machine(rover: str, body: str, soil: str) -> Bundle:
    """A rover on the soil of a body, without a scenario; rocks are of `rigid_rock`.

    Raises:
        ConfigError: with every problem of every file.
    """
    reader = BundleReader(YamlDocument("command line", {}), None, {})
    bundle = reader.read(rover, body, soil, "rigid_rock")
    if bundle is None:
        raise ConfigError(reader.problems)
    return bundle


def _with_line(problems: Sequence[Problem], document: YamlDocument, key: str) -> list[Problem]:
    """Add the line of the key that named a set to the problems that are about that key."""
    _, line = document.place((key,))
    return [
        dataclasses.replace(problem, line=line)
        if problem.file == document.file and problem.key == dotted((key,)) and problem.line is None
        else problem
        for problem in problems
    ]
