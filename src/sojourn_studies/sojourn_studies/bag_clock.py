"""The clock of a run as its growing bag tells it: nobody is heard, so that nothing of the run is other than without."""

import struct
import time
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode

from sojourn_bags.salvage import MAGIC
from sojourn_config.command_errors import CommandError

_HEAD, _FRAME_SIZE = struct.Struct("<BQQQ"), 9
"""Of a record: its kind and length; then, of a chunk, its first and last stamp (MCAP specification)."""
LOOK_S = 0.005
LONGEST_S = 120.0
"""Wall time after which a bag that does not grow is no clock [s]."""


class Reading(NamedTuple):
    """Wall time and simulation time of one moment [s]."""

    wall: float
    simulated: float

    def pace(self, later: "Reading") -> float:
        """Seconds of simulation in one of wall time until a later reading."""
        return (later.simulated - self.simulated) / (later.wall - self.wall)


class BagClock:
    """Of a run whose recorder is at work. run_dir: its folder."""

    def __init__(self, run_dir: Path) -> None:
        self._bag = run_dir / "bag"
        self._file, self._read, self._stamp = Path(), 0, 0

    def read(self) -> Reading:
        """The moment in which the next chunk of the bag is there. Raises CommandError where none comes."""
        before, end = self._look(), time.monotonic() + LONGEST_S
        while (stamp := self._look()) == before:
            if time.monotonic() > end:
                raise CommandError(f"{self._bag} has not grown for {LONGEST_S:g} s")
            time.sleep(LOOK_S)
        return Reading(time.monotonic(), stamp * 1e-9)

    def _look(self) -> int:
        """Stamp of the newest whole chunk [ns]."""
        for file in sorted(self._bag.glob("*.mcap"), key=lambda file: file.stat().st_mtime_ns)[-1:]:
            if file != self._file:
                self._file, self._read = file, len(MAGIC)
            size = file.stat().st_size
            with file.open("rb") as stream:
                while stream.seek(self._read) + _HEAD.size <= size:
                    opcode, length, _, end = _HEAD.unpack(stream.read(_HEAD.size))
                    following = self._read + _FRAME_SIZE + length
                    if following > size:
                        break
                    self._read = following
                    if opcode == Opcode.CHUNK:
                        self._stamp = end
        return self._stamp
