"""Everything that a machine on a body needs, read from its files and checked together."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sojourn_config.arm_config import ArmConfig
from sojourn_config.carrying_checks import carrying_problems
from sojourn_config.errors import MISSING, ConfigError, single
from sojourn_config.machine import MachineConfig
from sojourn_config.machine_body import STOWED, machine_body
from sojourn_config.machine_checks import machine_problems, with_drive_data
from sojourn_config.machine_reader import MachineReader, MachineSets
from sojourn_config.set_reader import ReadSet, Referrer
from sojourn_config.support_checks import ground_problems
from sojourn_config.tool_config import tool_ground_problems, with_tool
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import YamlDocument
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, steering_geometry
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.body import MachineBody
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.loads import BusParams
from sojourn_machine.tools import ToolParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.sensors.params import SensorSuiteParams
from sojourn_physics.soil.params import SoilParams

if TYPE_CHECKING:
    from sojourn_flight.mobility.mobility import Mobility


@dataclass(frozen=True, slots=True, eq=False)
class Bundle:
    """The parameter sets of a run.

    Args:
        machine: supports, drives, couplings (also the plant's MachineParams), those of its arm among them.
        urdf: the machine's URDF, with the arm that is mounted on it; `urdf.text` is the XML.
        body: planet or moon.
        soil, rock_soil: default soil of the ground, and soil of its rocks.
        extra_soils: soils of patches and of the soil raster.
        battery, bus: energy store and its loads.
        power_manager: what the power manager believes and its law.
        sensors: set of the sensors' node.
        arm: set of the arm node, None for a machine without one; rotor inertia and friction that its file leaves out
            are filled in from the machine's drives.
        tool: at the end of the arm, None where there is none.
        driving: set of the drive node; None for a machine that stands fast.
        files: text of every file that was read, by name; the scenario's is first.
        documents: the files of the sets by role, with what they build on and with overrides.
    """

    machine: MachineConfig
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
    driving: DriveParams | None
    files: dict[str, str]
    documents: Mapping[str, YamlDocument]

    @property
    def urdf_xml(self) -> str:
        """The URDF as text."""
        return self.urdf.text

    @property
    def soils(self) -> dict[str, SoilParams]:
        """The soils of the ground by name."""
        return {soil.name: soil for soil in (*self.extra_soils, self.rock_soil, self.soil)}

    def carried_arm(self) -> ArmConfig:
        """The set of the arm. Raises ConfigError for a machine without one."""
        if self.arm is None:
            raise single(next(iter(self.files)), "machine", self.urdf.file, "this machine has no arm")
        return self.arm

    @property
    def drive(self) -> DriveParams:
        """The set of the drive node. Raises ConfigError for a machine that stands fast."""
        if self.driving is None:
            raise single(self.urdf.file, "", MISSING, "this machine stands fast: it does not drive")
        return self.driving

    def machine_body(self) -> MachineBody:
        """The machine as its own computer knows it."""
        return machine_body(self.machine, self.urdf, self.gravity, self.arm_pose(STOWED))

    @property
    def steering(self) -> SteeringGeometryParams:
        """The wheels and tracks as the drive node sees them."""
        return steering_geometry(self.machine_body())

    def mobility(self) -> "Mobility[Any]":
        """What moves the machine. Raises ConfigError for a machine that stands fast."""
        return self.drive.mobility.build(self.drive, self.machine_body())

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


class BundleReader(MachineReader):
    """Reads the files of a scenario one after the other and collects the problems of all of them.

    Args:
        scenario: what names the files. path: its file, None for a command line.
        overrides: `KEY=VALUE` texts by what they are for.
    """

    def __init__(self, scenario: YamlDocument, path: Path | None, overrides: dict[str, list[str]]) -> None:
        super().__init__(overrides)
        self.files |= scenario.texts
        self._here = Referrer(scenario, path or Path(scenario.file))

    def read(
        self,
        machine: str,
        body: str,
        soil: str,
        rock_soil: str,
        extra_soils: Sequence[str] = (),
        mounted: str | None = None,
    ) -> Bundle | None:
        """All that a scenario names, or None with the reasons in `problems`. `mounted`: another tool."""
        here = self._here
        found_body = self.named("bodies", body, "body", BodyParams, here)
        found_soil = self.named("soils", soil, "soil", SoilParams, here)
        found_rock = self.named("soils", rock_soil, "rock_soil", SoilParams, here)
        found_extra = [self.named("soils", name, "terrain", SoilParams, here) for name in extra_soils]
        sets = self.machine(machine, here, mounted)
        extra = [found for found in found_extra if found is not None]
        if sets is None or found_body is None or found_soil is None or found_rock is None:
            return None
        if len(extra) < len(found_extra):
            return None
        self._check(sets, found_body.params, [found_soil, found_rock, *extra])
        if self.problems:
            return None
        joined = sets.joined
        return Bundle(
            machine=joined.config,
            urdf=joined.urdf,
            body=found_body.params,
            soil=found_soil.params,
            rock_soil=found_rock.params,
            extra_soils=tuple(found.params for found in extra),
            battery=joined.battery,
            bus=joined.bus,
            power_manager=PowerManagerParams(battery=joined.battery, loads=joined.bus.loads, law=joined.law),
            sensors=joined.sensors if sets.tool is None else with_tool(joined.sensors, sets.tool.params),
            arm=joined.arm and with_drive_data(joined.arm, joined.config),
            tool=sets.tool and sets.tool.params.tool,
            driving=sets.drive,
            files=self.files,
            documents={
                "scenario": here.document,
                **sets.documents,
                "body": found_body.document,
                "soil": found_soil.document,
                "rock_soil": found_rock.document,
            },
        )

    def _check(self, sets: MachineSets, body: BodyParams, soils: Sequence[ReadSet[SoilParams]]) -> None:
        """What does not fit together goes into `problems`."""
        tool = sets.tool and sets.tool.params
        for ground in {found.params.name: found for found in soils}.values():
            self.problems += ground_problems(sets.joined.config, ground.params, ground.document)
            self.problems += tool_ground_problems(tool, ground.params, ground.document)
        found = machine_problems(sets)
        self.problems += found or list(carrying_problems(sets.joined, body.surface_gravity, sets.documents))


def read_machine(machine: str, body: str, soil: str) -> Bundle:
    """A machine on the soil of a body, without a scenario; rocks are of `rigid_rock`.

    Raises:
        ConfigError: with every problem of every file.
    """
    reader = BundleReader(YamlDocument("command line", {}), None, {})
    bundle = reader.read(machine, body, soil, "rigid_rock")
    if bundle is None:
        raise ConfigError(reader.problems)
    return bundle
