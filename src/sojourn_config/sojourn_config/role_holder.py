"""Who on this machine runs a role: the holder of its token, an abstract Unix socket (unix(7)).

Linux gives such a name to one process only, takes it back however that process ends, leaves no file, and tells the
number of the process that holds it.
"""

import socket
import struct

_CREDENTIALS = struct.Struct("3i")
"""struct ucred: process, user, group."""


def token_name(domain: int, namespace: str, role: str) -> str:
    """Name of the socket. The leading zero byte makes it abstract: no file."""
    return f"\0sojourn/{domain}{namespace}/{role}"


def holder_of(domain: int, namespace: str, role: str) -> int:
    """Number of the process that holds a role, 0 if there is none or it is not to be found out."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        try:
            caller.connect(token_name(domain, namespace, role))
            found = caller.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        except OSError:
            return 0
    return int(_CREDENTIALS.unpack(found)[0])
