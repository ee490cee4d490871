"""Which campaign a folder is of: what its runs go by, kept in the folder and compared when it is opened again."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sojourn_config.command_errors import UsageError

IDENTITY, JOURNAL, LOCK = "campaign.json", "journal.jsonl", "lock"
_FRESH = "campaign.fresh"
"""Of the identity while it is written; it stays where that is cut off."""
FILES, READ = "files", "files read"
"""Of an identity: digests of the files that its runs read, by name; of all that one run reads, by the run."""
_GROWING = (FILES, READ)
"""More runs, with further values, read further files: of these what both campaigns name must be the same. That a run
reads a file that it did not read before is seen by the digest of all that it reads."""


def check_identity(path: Path, identity: dict[str, Any]) -> None:
    """Keep what a campaign goes by in its folder, or compare it with what is kept there.

    Args:
        identity: plain JSON values by name.

    Raises:
        UsageError: the folder is another campaign's or holds other things. OSError: it cannot be written.
    """
    file = path / IDENTITY
    if not (file.exists() and (path / JOURNAL).exists()):
        others = [one.name for one in path.iterdir() if one.name not in (LOCK, _FRESH)]
        if others and not file.exists():
            raise UsageError(f"{path}: holds {others[0]} and is no folder of a campaign: name an empty one with --out")
        _write(file, identity)
        return
    before = _read(file)
    pairs = {name: _comparable(name, before.get(name), identity[name]) for name in identity}
    differing = {name: (was, now) for name, (was, now) in pairs.items() if was != now}
    if differing:
        words = "; ".join(_difference(name, was, now) for name, (was, now) in differing.items())
        raise UsageError(
            f"{path} is the folder of another campaign: {words}. A table has the runs of one campaign: name another "
            "folder with --out"
        )
    both = before | identity | {name: before[name] | identity[name] for name in _GROWING if name in identity}
    if both != before:
        _write(file, both)


def _read(file: Path) -> dict[str, Any]:
    try:
        before = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{file}: cannot be read: {error}") from error
    if not isinstance(before, dict):
        raise UsageError(f"{file}: cannot be read: it does not say of which campaign it is")
    return before


def _write(file: Path, identity: Mapping[str, Any]) -> None:
    """The file is swapped in whole, and is on the disk then: without it the rows beside it are nobody's."""
    fresh = file.with_name(_FRESH)
    with fresh.open("w", encoding="utf-8") as stream:
        stream.write(json.dumps(identity, indent=1))
        stream.flush()
        os.fsync(stream.fileno())
    fresh.rename(file)


def _comparable(name: str, before: Any, now: Any) -> tuple[Any, Any]:
    """What is to be the same of two values of an identity."""
    if name in _GROWING and isinstance(before, dict) and isinstance(now, dict):
        shared = [key for key in now if key in before]
        return {key: before[key] for key in shared}, {key: now[key] for key in shared}
    return before, now


def _difference(name: str, before: Any, now: Any) -> str:
    if isinstance(before, dict) and isinstance(now, dict):
        keys = [key for key in {**before, **now} if before.get(key) != now.get(key)]
        return f"{name}: {', '.join(keys[:5])}{' and more' if len(keys) > 5 else ''} differ"
    return f"{name} was {json.dumps(before)}, and is {json.dumps(now)}"
