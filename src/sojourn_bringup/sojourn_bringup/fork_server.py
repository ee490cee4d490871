"""Our own nodes as copies of one process that has loaded what they share.

Loading libraries takes a node longer than all else at its start, and is the same for each. The fork server is a copy of
the process that starts the run, which has loaded most of them to check its plan. It runs nothing, and makes a copy of
itself for every request that comes over a socket (`forked.py`). That copy becomes the node of a role, with a group,
arguments, variables and a log of its own, as if it had been started by itself. The server tells of each end with its
status.

Nothing of ROS is loaded before a copy is made: its library starts threads, which a copy would not have.
"""

import os
import select
import signal
import socket
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from runpy import run_module
from typing import NoReturn

from setproctitle import setproctitle

from sojourn_bringup.child_process import die_with
from sojourn_bringup.forked import LONGEST, ForkRequest, read_request, told_of
from sojourn_config.collector import settle_collector
from sojourn_machine.arithmetic import pin

os.environ["SPT_NOENV"] = "1"  # a title is written over the arguments alone, not over the variables


def be_server(connection: socket.socket, parent: int, log: Path) -> NoReturn:
    """Be the server, in a process of which this is a copy, until the connection is closed; and in each copy, its node.

    Nothing of what the process before the copy has begun is ended here: neither its files nor its blocks.

    Args:
        connection: requests come over it. parent: the process that is copied; both end with it. log: takes what is
            printed.
    """
    status = 1
    try:
        die_with(parent)
        os.setpgid(0, 0)
        print_into(str(log))
        setproctitle("sojourn_fork_server")
        with suppress(Exception):  # the copies will say it, in their own logs
            import sojourn_stack.apps  # noqa: F401 - not above, where nothing could be said
        serve(connection)
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(status)  # whatever else there is to go on with is of the process that was copied


def serve(connection: socket.socket) -> None:
    """Make copies, until the other end is closed; in a copy: run what it is to be, and return when that has ended."""
    settle_collector()  # what is never looked at again stays shared between the copies
    connection.send(told_of(loaded=1))
    running: dict[int, int] = {}
    """Process by the descriptor that tells of its end."""
    poll = select.poll()
    poll.register(connection, select.POLLIN)
    while True:
        for descriptor, _ in poll.poll():
            if descriptor != connection.fileno():
                poll.unregister(descriptor)
                os.close(descriptor)
                _, status = os.waitpid(pid := running.pop(descriptor), 0)
                with suppress(OSError):
                    connection.send(told_of(pid=pid, status=os.waitstatus_to_exitcode(status)))
                continue
            text = connection.recv(LONGEST)
            if not text:
                return
            request, parent = read_request(text), os.getpid()
            pid = os.fork()
            if pid == 0:
                connection.close()
                for other in running:
                    os.close(other)
                die_with(parent)
                become(request)
                return
            if not request.in_own_session:
                os.setpgid(pid, pid)  # before it is told of, or a signal to its group would find none
            running[watched := os.pidfd_open(pid)] = pid
            poll.register(watched, select.POLLIN)
            connection.send(told_of(begun=pid))


def become(request: ForkRequest) -> None:
    """Be the program. Returns, or raises SystemExit, as it does."""
    if request.in_own_session:
        os.setsid()
    print_into(request.log)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.clear()
    os.environ.update(request.environment)
    pin()  # numba looks again before it compiles, and would then do so for this processor, and all kernels anew
    sys.argv = [request.module, *request.arguments]
    if request.title:
        setproctitle(request.title)
    run_module(request.module, run_name="__main__", alter_sys=True)


def print_into(log: str) -> None:
    """From here on nothing is read, and all that is printed is added to a file at once."""
    for number, file, how in ((0, os.devnull, os.O_RDONLY), (1, log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)):
        descriptor = os.open(file, how, 0o666)
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.dup2(1, 2)
    sys.stdout.reconfigure(write_through=True)  # type: ignore[union-attr]
