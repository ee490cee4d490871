"""One node's process: its command, its log, how it ended."""

import contextlib
import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Protocol, Self

from sojourn_bringup.child_process import dying_with_us
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.process_state import is_stopped, memory_mb
from sojourn_bringup.process_table import process
from sojourn_config.ros_environment import foreign_environment, is_ours, own_environment

STOP_S = 10.0
"""Wall time that a process has to end after SIGINT: to say farewell, on a host that may be busy, and then the
`TEARDOWN_S` after which a node of ours ends itself where the middleware does not come back."""
_LOG_TAIL_BYTES = 8192
_ROS_LOG = re.compile(r"^\[(?P<level>[A-Z]+)\] \[[0-9.]+\] \[[^\]]*\]: (?P<text>.*)$")
_EXCEPTION = re.compile(r"^(?:\w+\.)*(\w*(?:Error|Exception|Interrupt)): (?P<text>.*)$")


def command_of(plan: RunPlan, role: str, attempt: int = 0) -> list[str]:
    """Command of a role: our module, or what replaces it, with the same ROS arguments."""
    replacement = plan.replacements.get(role)
    program = shlex.split(replacement) if replacement else [sys.executable, "-m", process(role).module]
    return program + plan.ros_arguments(role, attempt)


def environment_of(plan: RunPlan, role: str, ros: Mapping[str, str]) -> dict[str, str]:
    """Environment of a role's process; a replacement that is not of our virtual environment gets nothing of it."""
    replacement = plan.replacements.get(role)
    if replacement and not is_ours(shlex.split(replacement)[0]):
        return foreign_environment(os.environ, ros)
    return own_environment(os.environ, ros)


class ChildProcess(Protocol):
    """What a child needs of its process: `subprocess.Popen` is one, a copy of the fork server another."""

    pid: int

    @property
    def stdin(self) -> IO[bytes] | None:
        """Of one that waits for a line."""

    def poll(self) -> int | None:
        """Exit status, negative for a signal; None while it runs."""

    def wait(self, timeout: float) -> int:
        """Exit status. Raises subprocess.TimeoutExpired where it still runs after `timeout` [s]."""


class Child:
    """A process in a group of its own, so that Ctrl-C reaches us only and what it starts can be stopped with it.

    Args:
        role: row of the process table. process: it has begun. log: file that takes what it prints.
    """

    def __init__(self, role: str, process: ChildProcess, log: Path) -> None:
        self.role = role
        self.log = log
        self._process = process

    @classmethod
    def of_command(
        cls, role: str, command: list[str], environment: Mapping[str, str], log: Path, hears: bool = False
    ) -> Self:
        """Start a command with these and no other variables; an earlier attempt's text in the log is kept.

        Args:
            hears: it waits for a line, see `tell`.
        """
        with log.open("ab") as output:
            started = subprocess.Popen(
                dying_with_us(command),
                env=dict(environment),
                stdin=subprocess.PIPE if hears else subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                process_group=0,
            )
        return cls(role, started, log)

    @property
    def pid(self) -> int:
        """Process number, also that of its group."""
        return self._process.pid

    @property
    def status(self) -> int | None:
        """None while it runs; else its exit status, negative for the signal that ended it."""
        return self._process.poll()

    @property
    def is_stopped(self) -> bool:
        """Whether it has been stopped, by SIGSTOP or a debugger, and could go on."""
        try:
            return is_stopped(self.pid)
        except OSError:
            return False

    def send(self, number: signal.Signals) -> None:
        """Send a signal to it and to whatever it has started."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)

    def tell(self) -> bool:
        """Give it the line for which it waits; whether it could be told."""
        pipe = self._process.stdin
        if pipe is None:
            return False
        try:
            with pipe:
                pipe.write(b"begin\n")
        except OSError:  # it has ended
            return False
        return True

    def wait(self, seconds: float) -> bool:
        """Wait for its end; whether it has ended."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def sweep(self) -> None:
        """After its end: kill what it has started and left behind."""
        self.send(signal.SIGKILL)

    def memory_mb(self) -> float:
        """Memory in use [MB, resident]; 0 once it has ended."""
        try:
            return memory_mb(self.pid)
        except OSError:
            return 0.0

    def how_it_ended(self) -> str:
        """In words: signal or status, and the last thing that it said."""
        status = self.status
        if status is None:
            return "still runs"
        if status < 0:
            return f"was killed by {signal.Signals(-status).name}"
        said = last_words(self.log)
        return f"ended with status {status}" + (f": {said}" if said else "")


def last_words(log: Path) -> str:
    """The last error in a log, else its last line; empty if it said nothing."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - _LOG_TAIL_BYTES))
            lines = file.read().decode(errors="replace").splitlines()
    except OSError:
        return ""
    lines = [line for line in lines if line.strip()]
    if not lines:
        return ""
    if exception := _EXCEPTION.match(lines[-1]):
        return exception["text"] or exception[1]
    for line in reversed(lines):
        entry = _ROS_LOG.match(line)
        if entry and entry["level"] in ("ERROR", "FATAL"):
            return entry["text"]
    entry = _ROS_LOG.match(lines[-1])
    return entry["text"] if entry else lines[-1].strip()
