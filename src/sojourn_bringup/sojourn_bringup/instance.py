"""One process a role, domain and namespace on this machine: who starts a role first holds it, see `role_holder`.

A second plant on a domain would drive the same machine twice; with this it is refused at once, before a node of it
disturbs the run that goes on.
"""

import os
import socket
from collections.abc import Iterable
from types import TracebackType
from typing import Self

from sojourn_config.command_errors import CommandError
from sojourn_config.role_holder import holder_of, token_name


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
        token = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            token.bind(token_name(self._domain, self._namespace, role))
            token.listen()
        except OSError as error:
            token.close()
            holder = holder_of(self._domain, self._namespace, role)
            if holder == os.getpid():
                holder = 0
            raise RoleInUseError(role, self._domain, self._namespace, holder) from error
        self._held.append(token)

    def _release(self) -> None:
        for token in self._held:
            token.close()
        self._held.clear()
