"""What a process must have to compute what the others of a campaign do: their code, libraries and arithmetic."""

import hashlib
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from sojourn_bags.provenance import PACKAGES, versions
from sojourn_machine import arithmetic
from sojourn_studies.campaign.errors import WorkerError

CODE = "code"
"""Name of the digest of our own sources; what a checkout calls its commit says less."""
Versions = tuple[tuple[str, str], ...]


@lru_cache(maxsize=1)
def versions_here() -> Versions:
    """Version of everything that shapes a run, by name, and the digest of our sources."""
    found = {name: version for name, version in versions().items() if name != "commit"}
    digest = hashlib.sha256()
    for package in (*(name for name in PACKAGES if name.startswith("sojourn_")), __package__):
        spec = find_spec(package)
        if spec is None or spec.origin is None:
            continue
        folder = Path(spec.origin).parent
        for path in sorted(folder.rglob("*.py")):
            digest.update(f"{package}/{path.relative_to(folder).as_posix()}\0".encode() + path.read_bytes())
    return (*found.items(), (CODE, digest.hexdigest()[:16]))


def check_alike(expected: Versions) -> None:
    """Raise WorkerError where this process would not compute what the one with these versions does."""
    here = dict(versions_here())
    for name, version in expected:
        if here.get(name) != version:
            raise WorkerError(f"{name} is {here.get(name)} on the worker, and {version} where the campaign was started")
    if wrong := _unpinned():
        raise WorkerError(
            f"the worker was started without {', '.join(wrong)} and would round in another way: start it with "
            "scripts/campaign --join SCHEDULER"
        )


@lru_cache(maxsize=1)
def _unpinned() -> tuple[str, ...]:
    """Variables of the arithmetic that did not stand so when this process began, before numpy was loaded."""
    entries = Path("/proc/self/environ").read_bytes().decode(errors="replace").split("\0")
    began = dict(entry.split("=", 1) for entry in entries if "=" in entry)
    return tuple(name for name, value in arithmetic.pins().items() if began.get(name) != value)
