"""The scenario of a run as a bag carries it: all that summary and report need, wherever it was read from."""

import json
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from pydantic import BaseModel

from sojourn_bags.errors import IncompleteConfigError
from sojourn_bags.reading import Bag
from sojourn_bags.writer import Attachment
from sojourn_config.rover import RoverConfig
from sojourn_config.scenario import LoadedScenario, ScenarioConfig
from sojourn_mechanics.terrain.generate import generate
from sojourn_mechanics.terrain.height_field import HeightField

CONFIGURATION_NAME = "configuration.json"
_MEDIA_TYPES = {".yaml": "application/yaml", ".urdf": "application/xml"}
_SETS = (
    "rover",
    "body",
    "soil",
    "rock_soil",
    "battery",
    "bus",
    "power_manager",
    "sensors",
    "arm",
    "drive",
    "steering",
)


@dataclass(frozen=True)
class Run:
    """What was run.

    Args:
        name: of the scenario. scenario: its content. rover: the machine. urdf: text of its URDF.
        resolved: every parameter set as it was used, with overrides and defaults, in plain JSON values.
        files: text of every file that was read, by name. overrides: texts that went over them.
    """

    name: str
    scenario: ScenarioConfig
    rover: RoverConfig
    urdf: str
    resolved: dict[str, Any]
    files: dict[str, str]
    overrides: tuple[str, ...] = ()

    @classmethod
    def of_scenario(cls, loaded: LoadedScenario) -> "Run":
        """Describe a loaded scenario."""
        sets: dict[str, BaseModel] = {
            "scenario": loaded.config,
            **{name: getattr(loaded, name) for name in _SETS},
        }
        return cls(
            name=loaded.name,
            scenario=loaded.config,
            rover=loaded.rover,
            urdf=loaded.urdf_xml,
            resolved={name: value.model_dump(mode="json") for name, value in sets.items()},
            files=dict(loaded.files),
            overrides=loaded.overrides,
        )

    @classmethod
    def of_bag(cls, bag: Bag) -> "Run":
        """Description in a bag. Raises IncompleteConfigError if there is none, or one of another version."""
        try:
            document = json.loads(bag.attachments[CONFIGURATION_NAME])
            resolved = document["resolved"]
            files = {name: bag.attachments[name].decode() for name in document["files"]}
            return cls(
                name=document["name"],
                scenario=ScenarioConfig.model_validate_json(json.dumps(resolved["scenario"])),
                rover=RoverConfig.model_validate_json(json.dumps(resolved["rover"])),
                urdf=next(text for name, text in files.items() if name.endswith(".urdf")),
                resolved=resolved,
                files=files,
                overrides=tuple(document["overrides"]),
            )
        except KeyError as error:
            raise IncompleteConfigError(f"{bag.path} has no {error.args[0]} attached") from error
        except (StopIteration, ValueError) as error:
            text = f"the configuration attached to {bag.path} is not one of this version: {error}"
            raise IncompleteConfigError(text) from error

    def terrain(self) -> HeightField:
        """The ground of the run, made again from its parameters and seed."""
        scenario = self.scenario
        return generate(scenario.terrain, scenario.soil, scenario.rock_soil, scenario.seed)

    def attachments(self) -> list[Attachment]:
        """Files that carry this description in a bag."""
        document = {
            "name": self.name,
            "overrides": list(self.overrides),
            "files": list(self.files),
            "resolved": self.resolved,
        }
        found = [Attachment(CONFIGURATION_NAME, "application/json", json.dumps(document, indent=1).encode())]
        for name, text in self.files.items():
            media_type = _MEDIA_TYPES.get(PurePosixPath(name).suffix, "text/plain")
            found.append(Attachment(name, media_type, text.encode()))
        return found
