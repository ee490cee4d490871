"""What a shadow has found: the file by which its process tells the supervisor."""

import json
import os
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

STARTING, READY, RUNNING, DONE, FAILED = "starting", "ready", "running", "done", "failed"
DIFFERS = "differs from ours"


@dataclass
class ShadowReport:
    """What a shadow has found so far.

    Args:
        state: one of the words above. detail: in words, for a person.
        lines: the comparison at the end, in words. result: the same as data.
    """

    state: str = STARTING
    detail: str = ""
    lines: list[str] = field(default_factory=list)
    result: dict[str, Any] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """What a person should hear of at once; empty while there is nothing new."""
        if self.state == READY:
            return "ready"
        return self.detail if self.state == FAILED or self.detail.startswith(DIFFERS) else ""

    def write(self, file: Path) -> None:
        """Put it in the place of what was there, whole at any moment."""
        part = file.with_suffix(".part")
        part.write_text(json.dumps(asdict(self), indent=2) + "\n", encoding="utf-8")
        os.replace(part, file)


def read_report(file: Path) -> ShadowReport:
    """What a shadow has written; a new one where it has not written yet."""
    if not file.is_file():
        return ShadowReport()
    return ShadowReport(**json.loads(file.read_text(encoding="utf-8")))
