"""A program that runs beside us, as a user starts it: whether it still runs, and what it has said so far."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from sojourn_config.command_errors import CommandError
from sojourn_config.interruption import ended_by_signals
from sojourn_config.ros_environment import own_environment, ros_variables

START_S = 600
"""Wall time within which it has to run [s]: a machine may be busy."""
END_S = 120.0
"""Wall time that it has to end after SIGINT; a recorder finishes its bag within that."""
LOOK_S = 0.005


class ProbedProgram:
    """A module run in a process of its own. A context manager: it is ended with it.

    Args:
        module: to run. options: of it. domain: of ROS. log: new file for what it says.

    Attributes:
        domain: as given.
    """

    name = "program"

    def __init__(self, module: str, options: Sequence[str], domain: int, log: Path) -> None:
        self._command = [sys.executable, "-m", module, *options, "--domain", str(domain)]
        self.domain, self._log = domain, log
        self._signals = ExitStack()

    def __enter__(self) -> Self:
        environment = own_environment(os.environ, ros_variables(self.domain))
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                self._command, stdout=log, stderr=subprocess.STDOUT, env=environment, start_new_session=True
            )
        self._signals.enter_context(ended_by_signals())
        return self

    def __exit__(self, *_error: object) -> None:
        with self._signals:
            self.end()

    def end(self) -> int:
        """Interrupt it where it still runs, and wait. Its exit status."""
        if self.runs:
            self._process.send_signal(signal.SIGINT)
        return self.wait()

    def wait(self) -> int:
        """Until it ends by itself; kill it where it does not. Its exit status."""
        try:
            return self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            return self._process.wait()

    @property
    def words(self) -> str:
        """What it has said so far."""
        return self._log.read_text(encoding="utf-8", errors="replace")

    @property
    def runs(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def require_running(self) -> None:
        """Raises CommandError with its last line where it has ended."""
        if not self.runs:
            said = self.words.strip().splitlines()
            raise CommandError(f"the {self.name} has ended: {said[-1] if said else 'it said nothing'}")

    def wait_for(self, pattern: str, longest_s: float = START_S) -> re.Match[str]:
        """Until it has said a pattern of one line. Raises CommandError where it has ended without, or not said it."""
        end = time.monotonic() + longest_s
        while not (found := re.search(pattern, self.words, re.MULTILINE)):
            if not self.runs and not re.search(pattern, self.words, re.MULTILINE):
                self.require_running()
            if time.monotonic() > end:
                raise CommandError(f"the {self.name} has not said {pattern!r} within {longest_s:g} s")
            time.sleep(LOOK_S)
        return found
