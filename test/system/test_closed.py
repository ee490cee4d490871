"""A stack that runs is closed: no socket of it can be reached from another machine, and its files are its owner's."""

import ipaddress
import os
import socket
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from programs import PATIENT, SHORT_RUN, Program

LISTENING = "0A"


def bound_sockets(process: int) -> Iterator[tuple[str, str, int]]:
    """Kind, address and port of every socket of a process that hears others: TCP that listens, and all UDP and raw."""
    inodes = set()
    for entry in Path(f"/proc/{process}/fd").iterdir():
        try:
            name = entry.readlink().name
        except OSError:
            continue
        if name.startswith("socket:["):
            inodes.add(name[8:-1])
    for kind in ("tcp", "tcp6", "udp", "udp6", "raw", "raw6"):
        for line in Path(f"/proc/{process}/net/{kind}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[9] in inodes and (not kind.startswith("tcp") or fields[3] == LISTENING):
                address, _, port = fields[1].partition(":")
                yield kind, address_of(address), int(port, 16)


def address_of(text: str) -> str:
    """As the kernel writes it: words of 32 bits in the order of this machine."""
    words = struct.pack(f"={len(text) // 8}I", *(int(text[place : place + 8], 16) for place in range(0, len(text), 8)))
    return str(ipaddress.ip_address(words))


def opened(program: Program) -> list[str]:
    """Sockets of a program's processes that others can reach, in words."""
    return [
        f"process {process}: {kind} {address}:{port}"
        for process in program.processes()
        for kind, address, port in bound_sockets(process)
        if not ipaddress.ip_address(address).is_loopback
    ]


def test_a_socket_that_is_open_is_seen() -> None:
    """The test of the tests below."""
    with socket.socket() as inside, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as outside:
        inside.bind(("127.0.0.1", 0))
        inside.listen()
        outside.bind(("0.0.0.0", 0))
        found = set(bound_sockets(os.getpid()))
        assert ("tcp", "127.0.0.1", inside.getsockname()[1]) in found
        assert ("udp", "0.0.0.0", outside.getsockname()[1]) in found
    assert address_of("00000000000000000000000001000000") == "::1"


@pytest.mark.parametrize("layout", [(), ("--composed",)], ids=["processes", "composed"])
def test_it_listens_to_this_machine_alone(
    layout: tuple[str, ...], start: Callable[..., Program], tmp_path: Path, domain: int
) -> None:
    place = ["--domain", domain, "--run-dir", tmp_path / "run", *PATIENT]
    program = start("start", SHORT_RUN, "--realtime", "--set", "steps=[]", *layout, *place)
    program.wait_until(lambda text: any(": running" in line for line in text.splitlines()), "it runs")
    heard = [one for process in program.processes() for one in bound_sockets(process)]
    assert any(kind == "udp" for kind, _, _ in heard), "nodes that meet nobody prove nothing"
    assert opened(program) == []
    program.end()
    found = [tmp_path / "run", *(tmp_path / "run").rglob("*")]
    assert len(found) > 3
    others = [str(path) for path in found if path.stat().st_mode & 0o077]
    assert others == [], "files of a run are its owner's"
