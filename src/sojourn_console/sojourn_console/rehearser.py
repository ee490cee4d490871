"""Has a drive rehearsed beside the page, by a program that yields to whatever else runs."""

import contextlib
import json
import subprocess
import threading
from collections.abc import Sequence

from sojourn_console import beside
from sojourn_console.rehearsed import RECKONED, RehearsedDrive, middle

MODULE = "sojourn_console.rehearsal"
_WORDS = 300
"""Of what a program that failed has said, the first letters."""


class Rehearser:
    """One rehearsal at a time; a new one ends the one before.

    Attributes:
        found: newest of each means; of what is reckoned several times the one in the middle. looks: the ends of those.
        problem: why there is none.
    """

    def __init__(self) -> None:
        self.found: dict[str, RehearsedDrive] = {}
        self.looks: tuple[RehearsedDrive, ...] = ()
        self.problem = ""
        self._child: subprocess.Popen[str] | None = None
        self._ready: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()
        """Held where it is decided whose a finding is."""

    def prepare(self) -> None:
        """Have a program ready that has loaded what it needs; it ends with whoever has it."""
        if self._ready is None or self._ready.poll() is not None:
            pipe = subprocess.PIPE
            self._ready = beside.start(MODULE, stdin=pipe, stdout=pipe, stderr=pipe, text=True)

    def begin(self, scenario: str, overrides: Sequence[str]) -> None:
        """Rehearse from a scenario with what goes over its files."""
        self.end()
        self.prepare()
        child, self._ready = self._ready, None
        if child is None or child.stdin is None:
            return
        with self._lock:
            self.found, self.looks, self.problem = {}, (), ""
            self._child = child
        with contextlib.suppress(BrokenPipeError):  # what it has said before it ended is told
            child.stdin.write(json.dumps([scenario, *overrides]) + "\n")
            child.stdin.close()
        threading.Thread(target=self._listen, args=(child,), name="rehearsal", daemon=True).start()

    @property
    def is_under_way(self) -> bool:
        """Whether something is still to come."""
        return self._child is not None

    def end(self) -> None:
        """End what is under way."""
        with self._lock:
            child, self._child = self._child, None
        if child is not None and child.poll() is None:
            child.kill()
            child.wait()

    def close(self) -> None:
        """End everything."""
        self.end()
        self._child, self._ready = self._ready, None
        self.end()

    def _listen(self, child: "subprocess.Popen[str]") -> None:
        looks: tuple[RehearsedDrive, ...] = ()
        for line in child.stdout or ():
            found = RehearsedDrive(**json.loads(line))
            if found.means == RECKONED and found.is_over:
                looks = (*looks, found)
                found = middle(looks)
            elif found.look:
                continue
            with self._lock:
                if self._child is child:
                    self.found, self.looks = {**self.found, found.means: found}, looks
        errors = child.stderr.read() if child.stderr is not None else ""
        status = child.wait()
        with self._lock:
            if self._child is child:
                if status:
                    self.problem = errors.strip()[:_WORDS] or f"it ended with status {status}"
                self._child = None
