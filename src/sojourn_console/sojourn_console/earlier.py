"""Has read beside the page what the run left behind before the page heard it, and lays it under what is heard since."""

import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sojourn_console import beside
from sojourn_console.model import TRACK, RunScene
from sojourn_console.traces import Traces
from sojourn_machine.params import FloatArray

MODULE = "sojourn_console.traces"
WAIT_S = 2.0
"""Wall time after which the bag holds what had been said when the run was first heard: a recorder finishes a piece of
its bag every half second.
"""
BEHIND_NS = 30_000_000_000
"""By which a bag of the run that is heard may be behind it then [ns of simulation]."""
AHEAD_NS = 1_000_000_000
"""By which its newest message may be ahead of the newest that is heard [ns of simulation]."""
FIRST_NS = 2_000_000_000
"""What is heard from before this time on has left nothing [ns of simulation]."""
PORTION = 500
"""Places of ruts that are laid under a scene at a time: pressing them into the ground takes some 20 ms."""


class _Ruts(NamedTuple):
    """Some places, as a scene has them in the fields of these names."""

    passed: tuple[FloatArray, ...] = ()
    lowered: tuple[FloatArray, ...] = ()


class EarlierTraces:
    """Of one page.

    Args:
        folder: of the run that is heard, as it was named; None: nothing is read.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._until, self._due = 0, 0.0
        self._reader: _Reader | None = None
        self._ruts: Iterator[_Ruts] = iter(())
        self._is_read = folder is None

    def under(self, scene: RunScene, now: float) -> RunScene:
        """The scene with what the run left behind before, once that has been read. now: wall time [s]."""
        if self._is_read or self._folder is None:
            for ruts in islice(self._ruts, 1):
                passed, lowered = (*scene.passed, *ruts.passed), (*scene.lowered, *ruts.lowered)
                scene = replace(scene, passed=passed, lowered=lowered)
            return scene
        if not self._until:
            self._until, self._due = scene.stamp, now + WAIT_S
            self._is_read = 0 < scene.stamp < FIRST_NS
        elif self._reader is None and now > self._due:
            self._is_read = True  # whatever becomes of it
            self._reader = _Reader(self._folder, self._until)
            self._is_read = False
        elif self._reader is not None and self._reader.is_done:
            try:
                found = self._reader.found()
            finally:
                self.close()
            if found is not None and self._until - BEHIND_NS <= found.newest <= scene.stamp + AHEAD_NS:
                self._ruts = _portions(found)
                return replace(scene, track=np.concatenate([found.track, scene.track])[-TRACK:])
        return scene

    def begin_anew(self) -> None:
        """Another run has begun."""
        self.close()
        self._until, self._is_read = 0, self._folder is None

    def close(self) -> None:
        """End it."""
        self._is_read, self._ruts = True, iter(())
        if self._reader is not None:
            self._reader.end()
            self._reader = None


def _portions(found: Traces) -> Iterator[_Ruts]:
    """What the ground has told itself, else where it was touched."""
    for begin in range(0, len(found.lowered), PORTION):
        yield _Ruts(lowered=(found.lowered[begin : begin + PORTION],))
    if not len(found.lowered):
        for begin in range(0, len(found.passed), PORTION):
            yield _Ruts(passed=(found.passed[begin : begin + PORTION],))


class _Reader:
    """The program that reads, which yields to whatever else runs.

    Args:
        folder: of the run. until: time up to which what is left counts [ns].
    """

    def __init__(self, folder: Path, until: int) -> None:
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the program
        words = str(folder), str(until)
        nothing = subprocess.DEVNULL
        self._program = beside.start(MODULE, words, in_background=True, stdin=nothing, stdout=self._output)

    @property
    def is_done(self) -> bool:
        """Whether it has ended."""
        return self._program.poll() is not None

    def found(self) -> Traces | None:
        """What it has read; None where it could not, which it has told by itself."""
        if self._program.returncode:
            return None
        self._output.seek(0)
        return Traces.load(self._output)

    def end(self) -> None:
        """End it, where it has not."""
        self._program.kill()
        self._program.wait()
        self._output.close()
