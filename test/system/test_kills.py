"""Nodes killed in mid-run, as `measure_kills` does it; how soon what happens, that is for the measurement to say."""

import re
from collections.abc import Callable

import pytest
from programs import Program


@pytest.mark.parametrize(
    ("role", "options", "words"),
    [
        ("power", [], r"was killed by SIGKILL after \d+ s of simulation: lock-step cannot go on without it"),
        ("plant", [], "was killed by SIGKILL"),
        ("drive", ["--realtime"], r"runs again after \d+\.\d\d s"),
    ],
)
def test_each_kill_is_told(
    start: Callable[..., Program], domain: int, role: str, options: list[str], words: str
) -> None:
    run = start("measure_kills", "--role", role, "--kills", 1, "--domain", domain, *options)
    run.wait()
    kill, bags, *_, last = run.text.splitlines()
    assert re.match(rf"{role}: noticed after \d+\.\d\d s, .*{words}", kill), run.text
    assert re.fullmatch(r"  the bags lack \d+\.\d\d s", bags), run.text
    assert last.startswith(f"{role}: 1 kills, noticed after "), run.text
