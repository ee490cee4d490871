"""What a node must not lose when its process ends: one small file, which is there whole or as it was before.

A critical data store as flight computers have one. The file says when it was written, in simulation time, and carries
a digest of its values, so that nobody goes on from half of it.
"""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

KEEP_EVERY_NS = 200_000_000
"""Simulation time from keeping to keeping [ns]."""


class KeptDataError(Exception):
    """A file that holds no kept data, with why."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What was kept last: a stamp [ns], and values as JSON has them."""

    stamp: int
    values: dict[str, Any]


class KeptData:
    """One file of a role."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, stamp: int, values: Mapping[str, Any]) -> None:
        """Keep these values in place of those before. Raises OSError."""
        text = json.dumps(values)
        data = json.dumps({"stamp": stamp, "digest": _digest(text), "values": text})
        self.path.parent.mkdir(exist_ok=True)
        beside = self.path.with_suffix(".new")
        beside.write_text(data, encoding="utf-8")
        os.replace(beside, self.path)

    def read(self) -> Kept | None:
        """What was kept last, None where nothing was. Raises KeptDataError for a file that is something else."""
        try:
            data = json.loads(self.path.read_text(encoding="utf-8"))
            stamp, digest, text = int(data["stamp"]), data["digest"], data["values"]
            if digest != _digest(text):
                raise KeptDataError(f"{self.path} is damaged: its digest is another")
            return Kept(stamp, dict(json.loads(text)))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise KeptDataError(f"{self.path} holds no kept data: {error}") from error


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()
