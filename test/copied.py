"""A fork server in a process of its own: the one of a test has threads, and cannot be copied."""

import os
import socket
import sys
from collections.abc import Mapping
from pathlib import Path

from sojourn_bringup.forked import ForkServer

PROGRAM = """
import socket, sys
from importlib import import_module
from pathlib import Path
from sojourn_bringup.fork_server import be_server

connection, parent, log, *modules = sys.argv[1:]
for module in modules:
    import_module(module)
be_server(socket.socket(fileno=int(connection)), int(parent), Path(log))
"""


def new_fork_server(log: Path, environment: Mapping[str, str], *modules: str) -> ForkServer:
    """One that ends with this process.

    Args:
        log: takes what it prints. environment: with which its libraries are loaded. modules: which it loads before it
            makes a copy, beside those of the stack.
    """
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        theirs.set_inheritable(True)
        given = [str(theirs.fileno()), str(os.getpid()), str(log), *modules]
        pid = os.posix_spawn(sys.executable, [sys.executable, "-c", PROGRAM, *given], environment)
    return ForkServer(ours, pid)
