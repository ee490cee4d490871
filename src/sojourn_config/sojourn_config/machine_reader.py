"""Reads the folder of a machine, config/machines/NAME, and joins the machine with the arm that it carries."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from sojourn_config.arm_config import ArmConfig
from sojourn_config.derived import laid_over, with_derived
from sojourn_config.derived_flight import derived_flight, placeholders, sensor_of
from sojourn_config.derived_power import derived_power
from sojourn_config.derived_sensors import derived_sensors
from sojourn_config.derived_slip import derived_slip
from sojourn_config.errors import MISSING, ConfigError
from sojourn_config.explain import problems_of
from sojourn_config.extends import PARTS
from sojourn_config.machine import MACHINE_KINDS, FlightSet, MachineConfig
from sojourn_config.machine_body import body_layout
from sojourn_config.measured_file import MEASURED
from sojourn_config.mounting import LoadedMachine, join, mount_problems
from sojourn_config.paths import SUFFIX, config_folder
from sojourn_config.set_reader import ReadSet, Referrer, SetReader
from sojourn_config.support_checks import support_problems
from sojourn_config.thermal_checks import thermal_problems
from sojourn_config.tool_config import ToolSet, pad_problem
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import Data, YamlDocument
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.errors import UnknownNameError
from sojourn_machine.names import names_text
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.thermal.thermal_params import ThermalParams
from sojourn_physics.sensors.params import SensorSuiteParams

Model = TypeVar("Model", bound=BaseModel)
MACHINES = "machines"
DRIVE = "drive"
ALARMS = "alarms"
COMPLETED = ("flight", "sensors")
"""Files that need not say all: what stands for them where they are not there stands for what they leave out, too."""
PARTS_OF_SENSORS: Mapping[str, str] = {"hazcam": "camera_flight", "sun": "sun_flight"}
"""What the drive goes by of a machine that has a sensor of a kind: sets of `config/parts`."""
PART_OF_SLIP = "slip_flight"
"""What it goes by where the curves of torque against slip are known."""
COMMAND_LINE = Referrer(YamlDocument("command line", {}), Path("command line"))
"""Names a set where no file does."""
POWER_TABLES = tuple(PowerParams.model_fields)
FILES: Mapping[str, tuple[str, ...]] = {
    "machine": (),
    "power": POWER_TABLES,
    "flight": ("drive", "power_manager"),
    "sensors": (),
    "thermal": (),
}
"""Files of a machine's folder, and the tables in them that an override may begin with; none: the file's own name."""
HEADS = tuple(head for file, tables in FILES.items() for head in tables or (file,))
"""First words of overrides that are for a machine's files."""
TABLES = tuple(head for tables in FILES.values() for head in tables)
"""Those of them that are tables in a file."""


@dataclass(frozen=True, slots=True, eq=False)
class MachineSets:
    """A machine as it was read.

    Args:
        joined: with its arm. own_urdf: without it.
        drive: None for a machine that stands fast. tool: None for an arm without one.
        thermal: None for a machine whose heat is not looked at.
        documents: its files by role (`machine`, `power`, `flight`, `sensors`; `arm`, `tool`, `thermal` and `alarms`
            where it has them).
    """

    joined: LoadedMachine
    own_urdf: UrdfSummary
    drive: DriveParams | None
    tool: ReadSet[ToolSet] | None
    thermal: ThermalParams | None
    documents: Mapping[str, YamlDocument]


class MachineFiles(NamedTuple):
    """What `flight.yaml` builds on."""

    config: MachineConfig
    urdf: UrdfSummary
    power: PowerParams
    sensors: YamlDocument


class MachineReader(SetReader):
    """Reads machines; what is wrong goes into `problems`, what was read into `files`."""

    def machine(self, name: str, asked: Referrer, mounted: str | None = None) -> MachineSets | None:
        """The machine that the key `machine` names; None with the reason in `problems`.

        Args:
            mounted: a tool in place of the machine's own, which `asked` names.
        """
        path = self.place(MACHINES, name, "machine", asked)
        read = None if path is None else self.config(path)
        if path is None or read is None:
            return None
        config = read.params
        urdf = self.urdf(config.urdf, read.asked)
        power = self._file(path, "power", PowerParams, config)
        sensors = None if urdf is None else self._sensors(path, config, urdf)
        flight = None
        if urdf is not None and sensors is not None and power is not None:
            flight = self._flight(path, MachineFiles(config, urdf, power.params, sensors.document))
        arm = self._arm(name, read)
        tool = self._tool(read, asked, mounted)
        known = len(self.problems)
        thermal = self._thermal(path, name)
        if urdf is None or power is None or flight is None or sensors is None:
            return None
        if len(self.problems) > known:
            return None
        if (config.arm is not None and arm is None) or (tool is None and (mounted or config.tool)):
            return None
        documents = {
            role: found.document
            for role, found in (
                ("machine", read), ("power", power), ("flight", flight),
                ("sensors", sensors), ("arm", arm), ("tool", tool), ("thermal", thermal),
            )
            if found is not None
        }  # fmt: skip
        documents |= self._alarms(path)
        law: FlightSet = flight.params
        alone = LoadedMachine(config, urdf, power.params, law.power_manager, sensors.params, arm and arm.params)
        joined = self._with_arm(alone, documents, arm)
        if joined is None:
            return None
        misplaced = tool and pad_problem(joined.config, tool.params, tool.document)
        self.problems += [misplaced] if misplaced else []
        if thermal is not None:
            self.problems += thermal_problems(thermal.params, joined.power, thermal.document)
        return MachineSets(joined, urdf, law.drive, tool, thermal and thermal.params, documents)

    def config(self, path: Path) -> ReadSet[MachineConfig] | None:
        """The set of `machine.yaml`, of the kind that it names; None with the reason in `problems`."""
        document = self.document(path, MACHINES, self._overrides_of("machine"))
        if document is None:
            return None
        name = document.data.get("kind")
        try:
            kind = MACHINE_KINDS.get(str(name))
        except UnknownNameError:
            known = names_text(str(name), MACHINE_KINDS.names())
            problem = document.problem(("kind",), MISSING, f"the key is missing: {known}")
            self.problems.append(problem if name is None else document.problem(("kind",), name, known))
            return None
        return self.validated(document, path, kind)

    def _thermal(self, path: Path, name: str) -> ReadSet[ThermalParams] | None:
        """`thermal.yaml`; None where the machine has none, or with the reason in `problems`."""
        own = path.with_name("thermal" + SUFFIX)
        if not own.is_file():
            self.refuse_overrides("thermal", f"the machine {name} has no thermal.yaml")
            return None
        document = self.document(own, MACHINES, self._overrides_of("thermal"))
        return None if document is None else self.validated(document, own, ThermalParams)

    def _alarms(self, path: Path) -> dict[str, YamlDocument]:
        """`alarms.yaml`, which the operator's side reads; none where the machine has none."""
        own = path.with_name(ALARMS + SUFFIX)
        document = self.document(own, MACHINES) if own.is_file() else None
        return {} if document is None else {ALARMS: document}

    def _sensors(self, path: Path, config: MachineConfig, urdf: UrdfSummary) -> ReadSet[SensorSuiteParams] | None:
        """`sensors.yaml`, and encoders on all joints where it names none."""
        own, document = self._document(path, "sensors", config)
        if document is not None and "joint_groups" not in document.data:
            document = with_derived(document, derived_sensors(config, urdf))
        return None if document is None else self.validated(document, own, SensorSuiteParams)

    def _flight(self, path: Path, files: "MachineFiles") -> ReadSet[FlightSet] | None:
        """`flight.yaml`, over what was measured, what a machine with its sensors goes by, and what follows from its
        battery and its size.
        """
        config, urdf, sensors = files.config, files.urdf, files.sensors.data
        own, document = self._document(path, "flight", config)
        if document is None:
            return None
        document = with_derived(document, derived_power(files.power))
        if isinstance(document.data.get(DRIVE), dict):
            measured = path.with_name(MEASURED)
            base = self.document(measured, PARTS) if measured.is_file() else None
            document = document if base is None else laid_over(document, base, DRIVE)
            document = self._with_slip(self._with_sensors(document, sensors), config, sensors)
            fits = not any(support_problems(config, urdf, YamlDocument("", {})))  # told later, with their lines
            derived = derived_flight(body_layout(config, urdf), sensors) if fits else placeholders()
            document = with_derived(document, derived)
        return self.validated(document, own, config.flight)

    def _with_sensors(self, flight: YamlDocument, sensors: Mapping[str, Data]) -> YamlDocument:
        """What the drive goes by of a machine with its sensors; of one whose sensor has been taken away, only what its
        file has begun to say.
        """
        for kind, name in PARTS_OF_SENSORS.items():
            base, drive = self.document(_part(name), PARTS), flight.data.get(DRIVE)
            if base is None or not isinstance(drive, dict):
                continue
            if not sensor_of(sensors, kind):
                begun = {key: table for key, table in base.data.items() if isinstance(drive.get(key), dict)}
                base = dataclasses.replace(base, data=begun)
            flight = laid_over(flight, base, DRIVE)
        return flight

    def _with_slip(self, flight: YamlDocument, config: MachineConfig, sensors: Mapping[str, Data]) -> YamlDocument:
        """What goes with the curves of torque against slip, where there are any."""
        drive = flight.data.get(DRIVE)
        mobility = drive.get("mobility") if isinstance(drive, dict) else None
        base = self.document(_part(PART_OF_SLIP), PARTS)
        if base is None or not isinstance(mobility, dict) or not isinstance(mobility.get("slip"), dict):
            return flight
        derived = {DRIVE: {"mobility": {"slip": derived_slip(config, sensors)}}}
        return with_derived(laid_over(flight, base, DRIVE), derived)

    def _file(self, path: Path, file: str, model: type[Model], config: MachineConfig) -> ReadSet[Model] | None:
        """One of the files beside `machine.yaml`, or what stands for it in machines of its kind."""
        own, document = self._document(path, file, config)
        return None if document is None else self.validated(document, own, model)

    def _document(self, path: Path, file: str, config: MachineConfig) -> tuple[Path, YamlDocument | None]:
        own = path.with_name(file + SUFFIX)
        default = _part(config.defaults[file]) if file in config.defaults else None
        if not own.is_file() and default is not None:
            own = default
        document = self.document(own, MACHINES, self._overrides_of(file))
        if document is not None and own != default and default is not None and file in COMPLETED:
            base = self.document(default, PARTS)
            document = document if base is None else laid_over(document, base)
        return own, document

    def _overrides_of(self, file: str) -> list[str]:
        if not FILES[file]:
            return self.overrides.get(file, [])
        return [text for head in FILES[file] for text in self.overrides.get(head, ())]

    def _with_arm(
        self, machine: LoadedMachine, documents: Mapping[str, YamlDocument], arm: ReadSet[ArmConfig] | None
    ) -> LoadedMachine | None:
        """The machine joined with its arm; None with the reason in `problems`."""
        arm_urdf = None
        if arm is not None and machine.config.arm_mount is not None and arm.params.urdf is not None:
            arm_urdf = self.urdf(arm.params.urdf, arm.asked)
            if arm_urdf is None:
                return None
        problems = list(mount_problems(machine, arm_urdf, documents))
        if problems:
            self.problems += problems
            return None
        try:
            joined = join(machine, arm_urdf)
        except ConfigError as error:
            self.problems += error.problems
            return None
        try:
            type(joined.config).model_validate(joined.config.model_dump())
        except ValidationError as error:
            self.problems += problems_of(error, type(joined.config), documents["machine"])
            return None
        return joined

    def _arm(self, name: str, machine: ReadSet[MachineConfig]) -> ReadSet[ArmConfig] | None:
        """The set of the arm; None where the machine has none, or with the reason in `problems`."""
        if machine.params.arm is not None:
            return self.load("arms", machine.params.arm, "arm", ArmConfig, machine.asked)
        self.refuse_overrides("arm", f"the machine {name} has no arm")
        return None

    def _tool(self, machine: ReadSet[MachineConfig], asked: Referrer, mounted: str | None) -> ReadSet[ToolSet] | None:
        """The set of the tool; None where the arm has none, or with the reason in `problems`."""
        name, asked = (mounted, asked) if mounted else (machine.params.tool, machine.asked)
        if name is None:
            self.refuse_overrides("tool", "the arm has no tool")
            return None
        if machine.params.arm is None:
            why = f"the machine {machine.params.urdf} has no arm"
            self.problems.append(asked.document.problem(("tool",), name, why))
            return None
        return self.load("tools", name, "tool", ToolSet, asked)


def _part(name: str) -> Path:
    return config_folder() / PARTS / (name + SUFFIX)


def machine_config(name: str) -> MachineConfig:
    """What `machine.yaml` of a machine says, without its other files. Raises ConfigError."""
    reader = MachineReader({})
    path = reader.place(MACHINES, name, "machine", COMMAND_LINE)
    found = None if path is None else reader.config(path)
    if found is None:
        raise ConfigError(reader.problems)
    return found.params


def joined_machine(name: str) -> LoadedMachine:
    """A machine with its arm, on no ground. Raises ConfigError."""
    reader = MachineReader({})
    found = reader.machine(name, COMMAND_LINE)
    if found is None or reader.problems:
        raise ConfigError(reader.problems)
    return found.joined
