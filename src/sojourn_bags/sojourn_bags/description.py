"""The scenario of a run as a bag carries it: all that summary and report need, wherever it was read from."""

import json
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

from pydantic import BaseModel

from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.errors import IncompleteConfigError
from sojourn_bags.reading import Bag
from sojourn_bags.writer import Attachment
from sojourn_config.machine import MACHINE_KINDS, MachineConfig
from sojourn_config.recorded_raster import ELEVATION_NAME, raster_bytes, raster_from
from sojourn_config.scenario import LoadedScenario, ScenarioConfig
from sojourn_config.urdf import parse_urdf
from sojourn_flight.mobility.choice import MOBILITIES
from sojourn_machine.tools import ToolParams, read_tool
from sojourn_physics.terrain.generate import generate
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.raster import Raster

COMPOSED_NAME = "machine.urdf"
"""Of a machine whose arm has a URDF of its own: both in one, as they were used."""
_MEDIA_TYPES = {".yaml": "application/yaml", ".urdf": "application/xml"}
_SETS = (
    "machine",
    "body",
    "soil",
    "rock_soil",
    "power",
    "power_manager",
    "sensors",
    "arm",
    "tool",
)


@dataclass(frozen=True)
class Run:
    """What was run.

    Args:
        name: of the scenario. scenario: its content. machine: what ran it. urdf: text of its URDF.
        resolved: every parameter set as it was used, with overrides and defaults, in plain JSON values.
        files: text of every file that was read, by name. overrides: texts that went over them.
        digests: SHA-256 of the data files of the terrain, by name. raster: what was read from them.
    """

    name: str
    scenario: ScenarioConfig
    machine: MachineConfig
    urdf: str
    resolved: dict[str, Any]
    files: dict[str, str]
    overrides: tuple[str, ...] = ()
    digests: dict[str, str] = field(default_factory=dict)
    raster: Raster | None = None

    @classmethod
    def of_scenario(cls, loaded: LoadedScenario) -> "Run":
        """Describe a loaded scenario."""
        sets: dict[str, BaseModel | None] = {
            "scenario": loaded.config,
            **{name: getattr(loaded, name) for name in _SETS},
            "drive": loaded.driving,
            "steering": loaded.steering if loaded.machine.rolling else None,
        }
        return cls(
            name=loaded.name,
            scenario=loaded.config,
            machine=loaded.machine,
            urdf=loaded.urdf_xml,
            resolved={name: value and value.model_dump(mode="json") for name, value in sets.items()},
            files=dict(loaded.files),
            overrides=loaded.overrides,
            digests=loaded.digests,
            raster=loaded.raster,
        )

    @classmethod
    def of_bag(cls, bag: Bag) -> "Run":
        """Description in a bag. Raises IncompleteConfigError if there is none, or one of another version."""
        try:
            document = json.loads(bag.attachments[CONFIGURATION_NAME])
            resolved = document["resolved"]
            files = {name: bag.attachments[name].decode() for name in document["files"]}
            elevation = bag.attachments.get(ELEVATION_NAME)
            return cls(
                name=document["name"],
                scenario=ScenarioConfig.model_validate_json(json.dumps(resolved["scenario"])),
                machine=_machine_of(resolved["machine"]),
                urdf=_urdf_of(bag, files),
                resolved=resolved,
                files=files,
                overrides=tuple(document["overrides"]),
                digests=document.get("digests", {}),
                raster=None if elevation is None else raster_from(elevation),
            )
        except KeyError as error:
            raise IncompleteConfigError(f"{bag.path} has no {error.args[0]} attached") from error
        except (StopIteration, ValueError) as error:
            text = f"the configuration attached to {bag.path} is not one of this version: {error}"
            raise IncompleteConfigError(text) from error

    @property
    def arm(self) -> dict[str, Any] | None:
        """Parameter set of the arm, None for a machine without one."""
        arm: dict[str, Any] | None = self.resolved["arm"]
        return arm

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm; none where there is no arm."""
        return () if self.arm is None else tuple(self.arm["joint_names"])

    @property
    def moving_joints(self) -> tuple[str, ...]:
        """Joints that move the machine over the ground; none of one that stands fast.

        Raises:
            UnknownNameError: it moves on what no package here knows.
        """
        drive = self.resolved.get("drive")
        if drive is None:
            return ()
        return MOBILITIES.get(drive["mobility"]["kind"]).model_validate(drive["mobility"]).joints(self.machine)

    @property
    def tool(self) -> ToolParams | None:
        """Tool on the arm, None where there is none."""
        tool = self.resolved.get("tool")
        return None if tool is None else read_tool(json.dumps(tool))

    @property
    def sliding_joints(self) -> frozenset[str]:
        """Joints whose positions are metres, not radians."""
        joints = parse_urdf(self.urdf, f"URDF of {self.name}").joints
        return frozenset(name for name, joint in joints.items() if joint.kind == "prismatic")

    def terrain(self) -> HeightField:
        """The ground of the run, made again from its parameters and seed."""
        scenario = self.scenario
        return generate(scenario.terrain, scenario.soil, scenario.rock_soil, scenario.seed, self.raster)

    def attachments(self) -> list[Attachment]:
        """Files that carry this description in a bag."""
        document = {
            "name": self.name,
            "overrides": list(self.overrides),
            "files": list(self.files),
            "digests": self.digests,
            "resolved": self.resolved,
        }
        found = [Attachment(CONFIGURATION_NAME, "application/json", json.dumps(document, indent=1).encode())]
        for name, text in self.files.items():
            media_type = _MEDIA_TYPES.get(PurePosixPath(name).suffix, "text/plain")
            found.append(Attachment(name, media_type, text.encode()))
        if self.urdf not in self.files.values():
            found.append(Attachment(COMPOSED_NAME, _MEDIA_TYPES[".urdf"], self.urdf.encode()))
        if self.raster is not None:
            found.append(Attachment(ELEVATION_NAME, "application/zip", raster_bytes(self.raster)))
        return found


def _machine_of(resolved: dict[str, Any]) -> MachineConfig:
    return MACHINE_KINDS.get(resolved["kind"]).model_validate_json(json.dumps(resolved))


def _urdf_of(bag: Bag, files: dict[str, str]) -> str:
    if COMPOSED_NAME in bag.attachments:
        return bag.attachments[COMPOSED_NAME].decode()
    found = [text for name, text in files.items() if name.endswith(".urdf")]
    if len(found) > 1:  # of the machine and of what it carries, each alone: what they make together is lost
        raise KeyError(COMPOSED_NAME)
    return next(iter(found))
