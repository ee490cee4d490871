"""ROS domains of the tests. Each is one test's alone on this machine, whatever else runs here at the time: other tests
beside it, another checkout's, a demo. A claim is a lock on a file, which ends with the process at the latest.
"""

import fcntl
import itertools
import os
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from sojourn_config.role_holder import token_name

LAST_DOMAIN = 100
"""Above it the ports of DDS lie where the system takes its own."""
_FOLDER = Path(tempfile.gettempdir()) / "sojourn-test-domains"
_next = itertools.count(os.getpid() * 7)
_kept: list[TextIO] = []


@contextmanager
def own_domain() -> Iterator[int]:
    """A domain that nobody else has, until the end of the block."""
    number, claim = _claim()
    with claim:
        yield number


def domain_to_keep() -> int:
    """A domain that nobody else has, until this process ends."""
    number, claim = _claim()
    _kept.append(claim)
    return number


def _claim() -> tuple[int, TextIO]:
    """The next domain in turn that is free, so that one just given back is not taken again at once."""
    _FOLDER.mkdir(exist_ok=True)
    for number in itertools.islice(_next, LAST_DOMAIN):
        domain = number % LAST_DOMAIN + 1
        claim = (_FOLDER / str(domain)).open("w")
        try:
            fcntl.flock(claim, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            claim.close()
            continue
        if _is_quiet(domain):
            return domain, claim
        claim.close()
    raise RuntimeError("no ROS domain is free")


def _is_quiet(domain: int) -> bool:
    """Whether nobody holds a role of a domain, nor the port of its first participant.

    A run that starts or ends has roles, and not yet or no longer the port (DDSI-RTPS 2.3, 9.6.1.1: 7410 + 250 a
    domain).
    """
    if token_name(domain, "", "").replace("\0", "@") in Path("/proc/net/unix").read_text(encoding="utf-8"):
        return False
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", 7410 + 250 * domain))
        except OSError:
            return False
    return True
