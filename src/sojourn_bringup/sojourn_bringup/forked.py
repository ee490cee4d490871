"""Asks the fork server for nodes, and hears of their ends: the supervisor's side of `fork_server`."""

import contextlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Self

from sojourn_bringup.plan import RunPlan

LONGEST = 1 << 17
"""Of a message on the socket [bytes]."""
KILLED = -9
"""Status of a copy whose fork server has ended: it is killed then."""
CLOSE_S = 5.0
"""Wall time that the server has to end."""


@dataclass(frozen=True)
class ForkRequest:
    """What a copy is to become.

    Args:
        module: run as `python -m MODULE`. arguments: of it. log: file that takes what it prints.
        environment: all its variables but those that pin our arithmetic, which it has anyway.
        title: its name in `ps`, one word, since the log of ROS has that name, too; empty: as the server's.
        in_own_session: not only in a group of its own.
    """

    module: str
    arguments: Sequence[str]
    log: str
    environment: Mapping[str, str]
    title: str = ""
    in_own_session: bool = False


def read_request(text: bytes) -> ForkRequest:
    """A request from the socket."""
    return ForkRequest(**json.loads(text))


def told_of(**what: int) -> bytes:
    """What the server says on the socket: once that it is `loaded`; of each copy its process when it has `begun`, and
    of its end `pid` and `status`, negative for the signal that ended it.
    """
    return json.dumps(what).encode()


class ForkServer:
    """A process that has loaded what the nodes of a run need.

    Args:
        connection: our end of its socket. pid: its process, a child of this one.
    """

    def __init__(self, connection: socket.socket, pid: int) -> None:
        self._socket, self._pid = connection, pid
        self._ended: dict[int, int] = {}
        self._is_loaded = False
        self.is_gone = False
        """It has ended, by itself or by `close`: it makes no more copies, and all that it has made are killed."""

    @classmethod
    def of_this_process(cls, log: Path) -> Self:
        """One that begins as a copy of this process, and ends with it.

        Raises:
            RuntimeError: this process has other threads, which a copy would not have.
        """
        if (threads := threads_here()) > 1:
            raise RuntimeError(f"{threads} threads in the process that is to be copied: allowed is one")
        from sojourn_bringup.fork_server import be_server  # not above: it needs this module

        log.parent.mkdir(exist_ok=True)
        sys.stdout.flush()  # or the copy would print it, too
        sys.stderr.flush()
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        parent = os.getpid()
        with theirs:
            pid = os.fork()
            if pid == 0:
                ours.close()
                be_server(theirs, parent, log)
        return cls(ours, pid)

    def is_loaded(self) -> bool:
        """Whether it makes copies at once; or none, as it has ended."""
        while not self._is_loaded and self._hear(0.0) is not None:
            pass
        return self._is_loaded or self.is_gone

    def fork(self, request: ForkRequest) -> "ForkedProcess | None":
        """A node begun, as soon as the server has loaded; None where that has ended, or the request is too long."""
        text = json.dumps(asdict(request)).encode()
        if len(text) > LONGEST:
            return None
        with contextlib.suppress(OSError):
            self._socket.send(text)
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
        """Let it end, and with it whatever still runs; once done, it changes nothing more."""
        if self._socket.fileno() < 0:
            return
        self._socket.close()
        self.is_gone = True
        watched = os.pidfd_open(self._pid)
        if not select.select([watched], [], [], CLOSE_S)[0]:
            os.kill(self._pid, signal.SIGKILL)
        os.close(watched)
        os.waitpid(self._pid, 0)

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


def threads_here() -> int:
    """How many this process has, those of libraries too."""
    return len(os.listdir("/proc/self/task"))


def fork_server_for(plan: RunPlan) -> contextlib.AbstractContextManager[ForkServer | None]:
    """What starts the nodes of a run that are ours. None where that would be one at most, or where a library of
    somebody else has begun threads here: then each starts by itself.
    """
    ours = [role for role in plan.started if role not in plan.replacements]
    if len(ours) < 2 or threads_here() > 1:
        return contextlib.nullcontext()
    return contextlib.closing(ForkServer.of_this_process(plan.run_dir / "logs" / "fork_server.log"))
