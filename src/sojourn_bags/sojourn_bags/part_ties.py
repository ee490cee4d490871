"""What ties the files of one bag together, so that one that is missing, doubled or of another bag is seen.

A file that goes on from another says of itself, in a metadata record, which part of its bag it is and what the end of
the file before it was; one that another follows says that it does. A bag of one file has no such record, and files that
were recorded before there was one are told apart by the numbers of their messages: a topic's go on from file to file.
"""

import hashlib
from collections.abc import Mapping
from io import SEEK_END
from pathlib import Path

PART_RECORD = "sojourn_part"
"""Name of the metadata record."""
OURS = "sojourn_bags"
"""Library of the header of a file of ours: others number their messages as they like."""
_NUMBER, _AFTER, _GOES_ON = "part", "after", "goes_on"
_TAIL = 1 << 16
"""Bytes at the end of a file by which the next one knows it: its index is among them."""


def follows(number: int, before: Path) -> dict[str, str]:
    """Record of a file that goes on from another. Raises OSError.

    Args:
        number: of the part, from zero. before: the file that it goes on from, which is finished.
    """
    return {_NUMBER: str(number), _AFTER: _end_of(before)}


def goes_on(number: int) -> dict[str, str]:
    """Record at the end of a part that another follows."""
    return {_NUMBER: str(number), _GOES_ON: "true"}


class PartTies:
    """Looks at the files of a bag in their order, and says of the first that does not fit.

    Args:
        alone: whether the bag has one file only.

    Attributes:
        broken: what does not fit, in words; "" where everything does.
    """

    def __init__(self, alone: bool) -> None:
        self._alone = alone
        self.broken = ""
        self._before: Path | None = None
        self._number = -1
        self._ours = self._is_tied = self._goes_on = self._went_on = False
        self._part = Path()
        self._counts: dict[str, int] = {}
        self._first: set[str] = set()

    def begin(self, part: Path) -> None:
        """The next file."""
        self._before, self._part = self._part if self._number >= 0 else None, part
        self._number += 1
        self._went_on, self._goes_on = self._goes_on, False
        self._ours = self._is_tied = False
        self._first = set()

    def header(self, library: str) -> None:
        """Who has written the file."""
        self._ours = library == OURS

    def record(self, values: Mapping[str, str]) -> None:
        """A record of this file about itself."""
        number = values.get(_NUMBER, "")
        if number != str(self._number):
            which = f"part {number} of its bag"
            self._break(f"is {which}, alone" if self._alone else f"is {which}, and stands as part {self._number}")
        self._goes_on |= _GOES_ON in values
        if _AFTER in values:
            self._is_tied = True
            if self._before is not None and values[_AFTER] != _end_of(self._before):
                self._break(f"is not of the same bag as {self._before.name}, or that file has been changed")

    def message(self, topic: str, sequence: int) -> None:
        """A message, and which of its topic its file says that it is, from zero."""
        count = self._counts.get(topic, 0)
        self._counts[topic] = count + 1
        if topic in self._first:
            return
        self._first.add(topic)
        if self._before is not None and self._ours and sequence != count:
            self._break(f"begins with message {sequence + 1} of {topic}, and message {count + 1} is next")

    def end(self) -> None:
        """The file is over, and it was sound."""
        if self._went_on and not self._is_tied:
            self._break("does not say that it goes on from the file before it")

    def finish(self) -> None:
        """There is no other file."""
        if self._goes_on:
            self._break(f"is followed by part {self._number + 1}, which is missing")

    def _break(self, what: str) -> None:
        self.broken = self.broken or f"{self._part.name} {what}"


def _end_of(file: Path) -> str:
    """SHA-256 of the end of a file. Raises OSError."""
    with file.open("rb") as stream:
        size = stream.seek(0, SEEK_END)
        stream.seek(max(0, size - _TAIL))
        return hashlib.sha256(stream.read()).hexdigest()
