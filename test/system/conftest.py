"""Fixtures of the system tests: domains of their own, and programs that end with the test."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from domains import own_domain

sys.path.insert(0, str(Path(__file__).parent))

from programs import Program


@pytest.fixture
def domain() -> Iterator[int]:
    """A domain of this test's own."""
    with own_domain() as number:
        yield number


@pytest.fixture
def start(tmp_path: Path, domain: int) -> Iterator[Callable[..., Program]]:
    """Starts programs, as `start("start", "flat_drive", "--domain", 7)`, and ends those that still run afterwards.

    It asks for the domain only to be ended before it: what runs on until the end of a test holds its place till then.
    """
    programs: list[Program] = []

    def begin(module: str, *arguments: str | Path | int) -> Program:
        words = [str(argument) for argument in arguments]
        program = Program(module, words, tmp_path / f"{len(programs)}_{module}.log")
        programs.append(program)
        return program

    yield begin
    for program in programs:
        program.end()
