"""Asks the fork server for nodes, and hears of their ends: the supervisor's side of `fork_server`."""

import contextlib
import json
import select
import socket
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from sojourn_bringup.child_process import dying_with_us
from sojourn_bringup.plan import RunPlan

LONGEST = 1 << 17
"""Of a message on the socket [bytes]."""
KILLED = -9
"""Status of a copy whose fork server has ended: it is killed then."""


@dataclass(frozen=True)
class ForkRequest:
    """What a copy is to become.

    Args:
        role: row of the process table. arguments: of its program. log: file that takes what it prints.
    """

    role: str
    arguments: Sequence[str]
    log: str


def read_request(text: bytes) -> ForkRequest:
    """A request from the socket."""
    return ForkRequest(**json.loads(text))


def told_of(**what: int) -> bytes:
    """What the server says on the socket: once that it is `loaded`; of each copy its process when it has `begun`, and
    of its end `pid` and `status`, negative for the signal that ended it.
    """
    return json.dumps(what).encode()


class ForkServer:
    """A process that has loaded what the nodes of a run need; it ends with this one.

    Args:
        plan: the run. environment: all variables, its own and those of the nodes. log: takes what it prints itself.
    """

    def __init__(self, plan: RunPlan, environment: Mapping[str, str], log: Path) -> None:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket = ours
        self._ended: dict[int, int] = {}
        self._is_loaded = False
        self.is_gone = False
        """It has ended, by itself or by `close`: it makes no more copies, and all that it has made are killed."""
        with theirs, log.open("ab") as output:
            program = [sys.executable, "-m", "sojourn_bringup.fork_server", str(theirs.fileno())]
            self._process = subprocess.Popen(
                dying_with_us([*program, plan.scenario, *plan.overrides]),
                env=dict(environment),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                pass_fds=(theirs.fileno(),),
                process_group=0,
            )

    def is_loaded(self) -> bool:
        """Whether it makes copies at once; or none, as it has ended."""
        while not self._is_loaded and self._hear(0.0) is not None:
            pass
        return self._is_loaded or self.is_gone

    def fork(self, request: ForkRequest) -> "ForkedProcess | None":
        """A node begun, as soon as the server has loaded; None where that has ended."""
        with contextlib.suppress(OSError):
            self._socket.send(json.dumps(asdict(request)).encode())
        while (told := self._hear(None)) is not None:
            if "begun" in told:
                return ForkedProcess(self, told["begun"])
        return None

    def status_of(self, pid: int, seconds: float = 0.0) -> int | None:
        """Exit status of a copy; None if it still runs after so many seconds."""
        until = time.monotonic() + seconds
        while pid not in self._ended and not self.is_gone:
            if self._hear(max(until - time.monotonic(), 0.0)) is None and time.monotonic() >= until:
                break
        return self._ended.get(pid, KILLED if self.is_gone else None)

    def close(self) -> None:
        """Let it end, and with it whatever still runs."""
        self._socket.close()
        self.is_gone = True
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._process.kill()
        self._process.wait()

    def _hear(self, seconds: float | None) -> dict[str, int] | None:
        """The next message within so many seconds (None: whenever it comes), or None. Ends are noted."""
        if self.is_gone or not select.select([self._socket], [], [], seconds)[0]:
            return None
        text = self._socket.recv(LONGEST)
        if not text:
            self.is_gone = True
            return None
        told: dict[str, int] = json.loads(text)
        self._is_loaded = True  # before that it says nothing
        if "status" in told:
            self._ended[told["pid"]] = told["status"]
        return told


class ForkedProcess:
    """A copy of the fork server, as `subprocess.Popen` has a process."""

    stdin = None

    def __init__(self, server: ForkServer, pid: int) -> None:
        self.pid = pid
        self._server = server

    def poll(self) -> int | None:
        """Exit status; None while it runs."""
        return self._server.status_of(self.pid)

    def wait(self, timeout: float) -> int:
        """Exit status. Raises subprocess.TimeoutExpired where it still runs after `timeout` [s]."""
        status = self._server.status_of(self.pid, timeout)
        if status is None:
            raise subprocess.TimeoutExpired([f"process {self.pid}"], timeout)
        return status
