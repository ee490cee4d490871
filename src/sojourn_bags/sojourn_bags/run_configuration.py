"""The configuration of a bag's run, written out again, so that a node can be started with it.

A bag carries every file that its run has read. They go into a folder of their own, laid out as the repository is
(config/, urdf/), and SOJOURN_CONFIG_DIR names it: so a node gets what the run had, whatever the files of today say. Of
an elevation model it carries the part that was used, which stands for the model's file.
"""

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.description import Run
from sojourn_bags.errors import IncompleteConfigError
from sojourn_bags.reading import Bag
from sojourn_config.errors import ConfigError
from sojourn_config.paths import ENVIRONMENT_VARIABLE, config_folder
from sojourn_config.recorded_raster import ELEVATION_NAME
from sojourn_config.scenario import load_scenario


@dataclass(frozen=True)
class RunConfiguration:
    """A run's configuration on disk.

    Args:
        scenario: path of its scenario. overrides: KEY=VALUE texts that go over it. folder: its config/.
        changed: files that read otherwise today, or are gone. resolved_otherwise: parameter sets that come to other
            values with today's code.
    """

    scenario: str
    overrides: tuple[str, ...]
    folder: Path
    changed: tuple[str, ...]
    resolved_otherwise: tuple[str, ...]

    @property
    def environment(self) -> dict[str, str]:
        """Variables for the process of a node."""
        return {ENVIRONMENT_VARIABLE: str(self.folder)}

    def parameters(self, participants: tuple[str, ...], timeout_s: float) -> dict[str, Any]:
        """ROS parameters of a node of the run."""
        values: dict[str, Any] = {
            "scenario": self.scenario,
            "lockstep": True,
            "participants": list(participants),
            "lockstep_timeout_s": float(timeout_s),
        }
        return values | ({"overrides": list(self.overrides)} if self.overrides else {})

    def warnings(self) -> list[str]:
        """What a person should know, in sentences."""
        found = []
        if self.changed:
            found.append(f"files of the run differ from those here, and the run's are used: {', '.join(self.changed)}")
        if self.resolved_otherwise:
            found.append(f"today's code makes other values of the run's files: {', '.join(self.resolved_otherwise)}")
        return found


@contextmanager
def run_configuration(bag: Bag) -> Iterator[RunConfiguration]:
    """Write a bag's configuration out, for as long as the context is open; SOJOURN_CONFIG_DIR points to it.

    Raises:
        IncompleteConfigError: the bag does not hold it. ConfigError: today's code refuses it.
    """
    try:
        document = json.loads(bag.attachments[CONFIGURATION_NAME])
        files = {str(name): bag.attachments[str(name)].decode() for name in document["files"]}
        overrides, resolved = tuple(document["overrides"]), document["resolved"]
        first = next(iter(files))
    except (KeyError, StopIteration, TypeError, ValueError) as error:
        raise IncompleteConfigError(f"{bag.path} does not hold the configuration of its run ({error})") from error
    changed = tuple(name for name, text in files.items() if _text_here(name) != text)
    with tempfile.TemporaryDirectory(prefix="sojourn-replay-") as base:
        for name, text in files.items():
            path = place_below(Path(base), name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        folder = Path(base) / "config"
        folder.mkdir(exist_ok=True)
        if ELEVATION_NAME in bag.attachments:
            (folder / ELEVATION_NAME).write_bytes(bag.attachments[ELEVATION_NAME])
        scenario = str(place_below(Path(base), first))
        with set_variable(ENVIRONMENT_VARIABLE, str(folder)):
            try:
                now = Run.of_scenario(load_scenario(scenario, overrides)).resolved
            except ConfigError as error:
                raise IncompleteConfigError(f"the configuration of {bag.path} is refused today: {error}") from error
            today = _as_json(now)
            otherwise = tuple(name for name in resolved if _said(resolved[name]) != _said(today.get(name)))
            yield RunConfiguration(scenario, overrides, folder, changed, otherwise)


def place_below(base: Path, name: str) -> Path:
    """Where a file goes: relative names as they are, absolute ones below a folder of their own."""
    parts = [part for part in PurePosixPath(name).parts if part not in ("/", "..")]
    return base.joinpath(*(["outside"] if name.startswith("/") else []), *parts)


def _text_here(name: str) -> str | None:
    """Text of the file of that name here, None without one."""
    try:
        return (config_folder().resolve().parent / name).read_text(encoding="utf-8")
    except OSError:
        return None


def _as_json(values: Mapping[str, Any]) -> dict[str, Any]:
    """As values look once they have been through JSON."""
    found: dict[str, Any] = json.loads(json.dumps(values))
    return found


def _said(values: Any) -> Any:
    """Values without those that say nothing: a key that there was not yet at the time of a run is none in its files."""
    if isinstance(values, list):
        return [_said(value) for value in values]
    if not isinstance(values, dict):
        return values
    said = {key: _said(value) for key, value in values.items()}
    return {key: value for key, value in said.items() if value not in (None, {}, [])}


@contextmanager
def set_variable(name: str, value: str) -> Iterator[None]:
    """An environment variable with another value, for as long as the context is open."""
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
