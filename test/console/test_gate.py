"""The page's server lets in who has its token, and nobody else."""

import contextlib
import http.client
from collections.abc import Iterator

import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from sojourn_console import gate
from sojourn_console.errors import UnguardedServerError
from sojourn_console.gate import HOST, GuardedServer, without_token

PROTOCOL = f"viser-v{viser.__version__}"


@pytest.fixture(scope="module")
def server() -> Iterator[GuardedServer]:
    server = GuardedServer("test", 8900)
    yield server
    server.stop()


def status_of(server: GuardedServer, path: str) -> int:
    connection = http.client.HTTPConnection(HOST, server.get_port(), timeout=10.0)
    with contextlib.closing(connection):
        connection.request("GET", path)
        return connection.getresponse().status


def test_the_page_is_behind_its_token(server: GuardedServer) -> None:
    assert server.address == f"http://127.0.0.1:{server.get_port()}/{server.token}/"
    assert status_of(server, f"/{server.token}/") == 200
    assert status_of(server, f"/{server.token}/?websocket=x") == 200
    for path in (
        "/",
        "/index.html",
        "/wrong/",
        f"/{server.token[:-1]}/",
        f"/{server.token}x/",
        "/?token=" + server.token,
    ):
        assert status_of(server, path) == 403, path


def test_no_websocket_is_opened_without_it(server: GuardedServer) -> None:
    base = f"ws://{HOST}:{server.get_port()}"
    for path in ("", "/", "/wrong"):
        with pytest.raises(InvalidStatus, match="403"):
            connect(base + path, subprotocols=[PROTOCOL], open_timeout=10.0)
    with connect(f"{base}/{server.token}", subprotocols=[PROTOCOL], open_timeout=10.0) as websocket:
        assert websocket.recv(timeout=10.0)


def test_two_servers_have_two_tokens(server: GuardedServer) -> None:
    other = GuardedServer("other", server.get_port())
    try:
        assert other.get_port() != server.get_port() and other.token != server.token
        assert status_of(other, f"/{server.token}/") == 403
        assert status_of(other, f"/{other.token}/") == 200
    finally:
        other.stop()


def test_what_else_serves_in_this_process_is_left_alone(server: GuardedServer) -> None:
    bare = viser.ViserServer(HOST, 8950, verbose=False)
    try:
        connection = http.client.HTTPConnection(HOST, bare.get_port(), timeout=10.0)
        connection.request("GET", "/")
        assert connection.getresponse().status == 200
    finally:
        bare.stop()


def test_a_server_that_asks_nobody_is_not_started(monkeypatch: pytest.MonkeyPatch) -> None:
    """As it would be if a new viser served by other means."""
    monkeypatch.setattr(gate, "_asking", lambda token: contextlib.nullcontext())
    with pytest.raises(UnguardedServerError, match="not started"):
        GuardedServer("open", 8960)


def test_it_is_not_shared_on_the_internet(server: GuardedServer) -> None:
    assert server.request_share_url() is None


@given(st.text(st.characters(codec="ascii", exclude_characters="/?"), min_size=1), st.text(max_size=20))
def test_a_path_is_cut_after_its_token_alone(token: str, other: str) -> None:
    assert without_token(f"/{token}", token) == "/"
    assert without_token(f"/{token}/a/b?c=/d", token) == "/a/b"
    found = without_token(f"/{other}", token)
    assert (found is not None) == (other.partition("?")[0].partition("/")[0] == token)
