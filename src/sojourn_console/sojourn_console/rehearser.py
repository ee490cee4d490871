"""Has a drive rehearsed beside the page, by a program that yields to whatever else runs."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Sequence

from sojourn_console.rehearsed import RehearsedDrive

MODULE = "sojourn_console.rehearsal"
_NICE = 10
_WORDS = 300
"""Of what a program that failed has said, the first letters."""


class Rehearser:
    """One rehearsal at a time; a new one ends the one before.

    Attributes:
        forecast: what has been found so far, None as long as nothing has. problem: why there is none.
    """

    def __init__(self) -> None:
        self.forecast: RehearsedDrive | None = None
        self.problem = ""
        self._child: subprocess.Popen[str] | None = None

    def begin(self, scenario: str, overrides: Sequence[str]) -> None:
        """Rehearse from a scenario with what goes over its files."""
        self.end()
        self.forecast, self.problem = None, ""
        child = self._child = subprocess.Popen(
            ["nice", "-n", str(_NICE), sys.executable, "-m", MODULE, scenario, *overrides],
            env=dict(os.environ),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        threading.Thread(target=self._listen, args=(child,), name="rehearsal", daemon=True).start()

    @property
    def is_under_way(self) -> bool:
        """Whether something is still to come."""
        return self._child is not None

    def end(self) -> None:
        """End what is under way."""
        child, self._child = self._child, None
        if child is not None and child.poll() is None:
            child.kill()
            child.wait()

    def _listen(self, child: "subprocess.Popen[str]") -> None:
        for line in child.stdout or ():
            if self._child is child:
                self.forecast = RehearsedDrive(**json.loads(line))
        errors = child.stderr.read() if child.stderr is not None else ""
        if self._child is child:
            if child.wait():
                self.problem = errors.strip()[:_WORDS] or f"it ended with status {child.returncode}"
            self._child = None
