"""One process a role, domain and namespace on this machine: who starts a role first holds it.

An abstract Unix socket (unix(7)) is the token: Linux gives a name to one process only, takes it back however that
process ends, leaves no file, and tells the number of the process that holds it. A second plant on a domain would drive
the same machine twice; with this it is refused at once, before a node of it disturbs the run that goes on.
"""

import os
import socket
import struct
from collections.abc import Iterable
from types import TracebackType
from typing import Self

from sojourn_config.command_errors import CommandError

_CREDENTIALS = struct.Struct("3i")
"""struct ucred: process, user, group."""


class RoleInUseError(CommandError):
    """A role is already run on this domain."""

    def __init__(self, role: str, domain: int, namespace: str, holder: int) -> None:
        place = f"domain {domain}" + (f", namespace {namespace}" if namespace else "")
        who = f" (process {holder})" if holder else ""
        super().__init__(
            f"{place} is in use: a run on this machine has a {role} there already{who}; stop it, or choose another "
            "place with --domain or --namespace"
        )
        self.role, self.holder = role, holder


class RoleTokens:
    """Holds roles of a domain and namespace while it is open. A context manager.

    Args:
        domain, namespace: where the nodes meet. roles: those that are started here.

    Raises:
        RoleInUseError: on entering, if another process on this machine holds one of them.
    """

    def __init__(self, domain: int, namespace: str, roles: Iterable[str]) -> None:
        self._domain, self._namespace = domain, namespace
        self._roles = tuple(roles)
        self._held: list[socket.socket] = []

    def __enter__(self) -> Self:
        try:
            for role in self._roles:
                self._take(role)
        except RoleInUseError:
            self._release()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._release()

    def _take(self, role: str) -> None:
        # the leading zero byte makes the name abstract: no file
        name = f"\0sojourn/{self._domain}{self._namespace}/{role}"
        token = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            token.bind(name)
            token.listen()
        except OSError as error:
            token.close()
            holder = _holder(name)
            if holder == os.getpid():
                holder = 0
            raise RoleInUseError(role, self._domain, self._namespace, holder) from error
        self._held.append(token)

    def _release(self) -> None:
        for token in self._held:
            token.close()
        self._held.clear()


def _holder(name: str) -> int:
    """Number of the process that listens under a name, 0 if it is not to be found out."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        try:
            caller.connect(name)
            found = caller.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        except OSError:
            return 0
    return int(_CREDENTIALS.unpack(found)[0])
