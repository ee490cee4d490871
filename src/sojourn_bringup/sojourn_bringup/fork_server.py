"""Our own nodes as copies of one process that has loaded what they share.

    python -m sojourn_bringup.fork_server FD SCENARIO [OVERRIDE ...]

Loading libraries and reading the run's files takes a node longer than all else at its start, and is the same for each.
This process does it once, runs nothing, and makes a copy of itself for every request that comes over the socket FD
(`forked.py`). The copy becomes the node of a role, with a group, arguments and a log of its own, as if it had been
started by itself. It tells of each end with its status.

Nothing of ROS is loaded here: its library starts threads, which a copy would not have.
"""

import os
import select
import signal
import socket
import sys
from contextlib import suppress
from importlib import import_module

from setproctitle import setproctitle

from sojourn_bringup.child_process import die_with
from sojourn_bringup.forked import LONGEST, ForkRequest, read_request, told_of
from sojourn_bringup.process_table import process
from sojourn_config.collector import collect_seldom, settle_collector

os.environ["SPT_NOENV"] = "1"  # a title is written over the arguments alone, not over the variables


def main() -> None:
    """Load, and serve until the socket is closed; in a copy, be the node."""
    connection, (scenario, *overrides) = socket.socket(fileno=int(sys.argv[1])), sys.argv[2:]
    setproctitle("sojourn_fork_server")
    collect_seldom()
    with suppress(Exception):  # the copies will say it, in their own logs
        import sojourn_stack.apps  # noqa: F401 - not above, where nothing could be said
        from sojourn_config.scenario import load_scenario

        load_scenario(scenario, overrides)
    settle_collector()  # what is never looked at again stays shared between the copies
    connection.send(told_of(loaded=1))
    request = serve(connection)
    if request is not None:
        become(request)


def serve(connection: socket.socket) -> ForkRequest | None:
    """Make copies, until the other end is closed: then None. In a copy: what it is to become."""
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
                return None
            parent = os.getpid()
            pid = os.fork()
            if pid == 0:
                connection.close()
                for other in running:
                    os.close(other)
                die_with(parent)
                return read_request(text)
            os.setpgid(pid, pid)  # before it is told of, or a signal to its group would find none
            running[watched := os.pidfd_open(pid)] = pid
            poll.register(watched, select.POLLIN)
            connection.send(told_of(begun=pid))


def become(request: ForkRequest) -> None:
    """Be the node. Ends this process."""
    for number, file, how in ((0, os.devnull, os.O_RDONLY), (1, request.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)):
        descriptor = os.open(file, how, 0o666)
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.dup2(1, 2)
    sys.stdout.reconfigure(write_through=True)  # type: ignore[union-attr]
    signal.signal(signal.SIGINT, signal.default_int_handler)
    module = import_module(process(request.role).node_class.partition(":")[0])
    sys.argv = [str(module.__file__), *request.arguments]
    setproctitle(f"sojourn_{request.role}")  # the log of ROS has this name, too: no more than a word
    module.main()


if __name__ == "__main__":
    main()
