"""What a bag says about where it is from: scenario, configuration as resolved, machine, versions.

With these attachments a bag explains itself: summary and report need no other file.
"""

import json
import platform
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path

from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.description import Run
from sojourn_bags.errors import IncompleteConfigError
from sojourn_bags.reading import Bag
from sojourn_bags.writer import Attachment
from sojourn_config.errors import ConfigError
from sojourn_config.paths import repository_root
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.description import contract_data
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import STANDARD

RUN_NAME = "run.json"
"""Name of the attachment with the same content, which is there from the first moment: also in a bag cut off."""
VERSIONS_NAME = "versions.json"
CONTRACT_NAME = "contract.json"
"""The contract under which the run was recorded, as `scripts/contract show --format json` prints it."""
PACKAGES = (
    *(f"sojourn_{part}" for part in ("machine", "physics", "flight", "analysis", "config", "contract")),
    *(f"sojourn_{part}" for part in ("plant", "sensors", "drive", "arm", "power")),
    *(f"sojourn_{part}" for part in ("bags", "operator", "stack", "bringup")),
    "numpy",
    "numba",
    "scipy",
    "pin",
    "ruckig",
    "rclpy",
    "mcap",
    "rosbags",
)
_NEEDED = {"lockstep", "participants"}
"""Keys without which a bag does not say how its run was."""


def attachments(scenario: LoadedScenario) -> list[Attachment]:
    """Files to put into the bag of a run of this scenario."""
    return [*Run.of_scenario(scenario).attachments(), versions_attachment(), contract_attachment(table_of(scenario))]


def run_attachment(run: Mapping[str, str]) -> Attachment:
    """Who took part in the run and how: scenario, lockstep, participants, namespace."""
    return Attachment(RUN_NAME, "application/json", json.dumps(dict(run), indent=2).encode())


def run_of(bag: Bag) -> dict[str, str]:
    """Who took part in the run of a bag and how. Raises IncompleteConfigError where the bag does not say."""
    if bag.records.get(RUN_RECORD, {}).keys() >= _NEEDED:
        return dict(bag.records[RUN_RECORD])
    try:
        found = {str(key): str(value) for key, value in json.loads(bag.attachments[RUN_NAME]).items()}
        return {**found, **{key: found[key] for key in _NEEDED}}
    except (KeyError, ValueError, AttributeError) as error:
        raise IncompleteConfigError(f"{bag.path} does not say which roles took part in its run") from error


def is_in_real_time(bag: Bag) -> bool:
    """Whether a bag is of a run in real time. Raises IncompleteConfigError."""
    return run_of(bag)["lockstep"] != "true"


def versions_attachment() -> Attachment:
    """Versions of everything that shaped the run."""
    return Attachment(VERSIONS_NAME, "application/json", json.dumps(versions(), indent=2).encode())


def contract_attachment(table: TopicTable = STANDARD) -> Attachment:
    """The contract of a run with these topics."""
    return Attachment(CONTRACT_NAME, "application/json", json.dumps(contract_data(table), indent=1).encode())


def versions() -> dict[str, str]:
    """Version of Python, of the packages that are installed, and the commit of the repository."""
    found = {"python": platform.python_version(), "machine": platform.machine()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed as a package"
    found["commit"] = commit() or "unknown"
    return found


def commit() -> str:
    """Commit that the repository is at, "" without one. Reads git's files, starts no program."""
    try:
        folder = repository_root() / ".git"
    except ConfigError:
        return ""
    if folder.is_file():  # a work tree says where its folder is
        folder = Path(folder.read_text(encoding="utf-8").partition("gitdir:")[2].strip())
    head = folder / "HEAD"
    if not head.is_file():
        return ""
    text = head.read_text(encoding="utf-8").strip()
    if not text.startswith("ref:"):
        return text
    reference = text.removeprefix("ref:").strip()
    for base in _git_folders(folder):
        if (base / reference).is_file():
            return (base / reference).read_text(encoding="utf-8").strip()
        packed = base / "packed-refs"
        if packed.is_file():
            for line in packed.read_text(encoding="utf-8").splitlines():
                if line.endswith(" " + reference):
                    return line.split(" ")[0]
    return ""


def _git_folders(folder: Path) -> Iterator[Path]:
    """The folder, and the one that a work tree shares."""
    yield folder
    common = folder / "commondir"
    if common.is_file():
        yield (folder / common.read_text(encoding="utf-8").strip()).resolve()
