"""Who on this machine runs a role: the holder of its token, an abstract Unix socket (unix(7)).

Linux gives such a name to one process only, takes it back however that process ends, leaves no file, and tells the
number of the process that holds it.
"""

import socket
import struct
from collections.abc import Iterable
from pathlib import Path

_CREDENTIALS = struct.Struct("3i")
"""struct ucred: process, user, group."""


def token_name(domain: int, namespace: str, role: str) -> str:
    """Name of the socket. The leading zero byte makes it abstract: no file."""
    return f"\0sojourn/{domain}{namespace}/{role}"


def holder_of(domain: int, namespace: str, role: str) -> int:
    """Number of the process that holds a role, 0 if there is none or it is not to be found out.

    Nobody answers the call, which stays in the holder's queue: after some hundred calls it is full, and no number is
    to be had. So this is for who asks once; see `held_roles`.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        caller.setblocking(False)
        try:
            caller.connect(token_name(domain, namespace, role))
            found = caller.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        except OSError:
            return 0
    return int(_CREDENTIALS.unpack(found)[0])


def held_roles(domain: int, namespace: str, roles: Iterable[str]) -> list[str]:
    """Which of these roles somebody on this machine holds; none where the kernel does not say (proc(5), net/unix)."""
    try:
        taken = set(Path("/proc/net/unix").read_text(encoding="utf-8", errors="replace").split())
    except OSError:
        return []
    return [role for role in roles if token_name(domain, namespace, role).replace("\0", "@") in taken]
