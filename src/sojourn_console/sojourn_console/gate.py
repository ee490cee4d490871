"""The page's server, which lets in only who has its token.

The token is the first part of the path: the page is at http://127.0.0.1:PORT/TOKEN/, and the browser opens the
websocket below the same path. What asks for anything else, page or websocket, gets 403 before viser sees the request.
viser offers no such question of its own; it serves with `websockets.asyncio.server.serve`, whose `process_request` is
the place for it. So while viser's server starts, that function is given ours in front of viser's. Whether it has taken
is then tried: a server that answers without the token is stopped, and the console with it.
"""

import http
import http.client
import secrets
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import viser
from websockets.asyncio import server as websocket_server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from sojourn_console.errors import UnguardedServerError

HOST = "127.0.0.1"
FIRST_PORT = 8680
"""The next free one from here on is taken."""
_TRY_S = 5.0
_starting = threading.Lock()


class GuardedServer(viser.ViserServer):
    """viser's server on loopback behind a token; nothing of it leaves this machine.

    Args:
        label: name of the page. port: the first that is tried. token: left out, a new one.

    Raises:
        UnguardedServerError: it would let in anybody.
    """

    def __init__(self, label: str, port: int = FIRST_PORT, token: str = "") -> None:
        self.token = token or secrets.token_urlsafe(18)
        with _starting, _asking(self.token):
            super().__init__(host=HOST, port=port, label=label, verbose=False)
        if _status(self.get_port(), "/") != http.HTTPStatus.FORBIDDEN:
            self.stop()
            raise UnguardedServerError

    @property
    def address(self) -> str:
        """Where the page is, with its token."""
        return f"http://{HOST}:{self.get_port()}/{self.token}/"

    def request_share_url(self, verbose: bool = True) -> None:
        """None: viser would put the page on the internet for whoever asks over the websocket."""
        return


def without_token(path: str, token: str) -> str | None:
    """A path without the token that it begins with; None for one that does not."""
    first, slash, rest = path.removeprefix("/").partition("?")[0].partition("/")
    if not secrets.compare_digest(first.encode(), token.encode()):
        return None
    return f"/{rest}" if slash else "/"


@contextmanager
def _asking(token: str) -> Iterator[None]:
    """Servers that are made within it ask for the token first."""
    serve = websocket_server.serve

    def guarded(*arguments: Any, **options: Any) -> Any:
        answer = options.get("process_request")
        return serve(*arguments, **{**options, "process_request": _guard(token, answer)})

    websocket_server.serve = guarded  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        websocket_server.serve = serve  # type: ignore[misc]


def _guard(token: str, answer: Callable[[Any, Request], Response | None] | None) -> Callable[..., Response | None]:
    def process_request(connection: Any, request: Request) -> Response | None:
        path = without_token(request.path, token)
        if path is None:
            text = b"The address of this console has a token, which is not in yours: see where it was started.\n"
            told = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(text))})
            return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", told, text)
        return None if answer is None else answer(connection, replace(request, path=path))

    return process_request


def _status(port: int, path: str) -> int:
    """Status with which the server answers a request."""
    connection = http.client.HTTPConnection(HOST, port, timeout=_TRY_S)
    try:
        connection.request("GET", path)
        return connection.getresponse().status
    finally:
        connection.close()
