"""Errors of the configuration: every problem found, each with file, key, value and what is allowed."""

from collections.abc import Iterable
from dataclasses import dataclass

MAX_SHOWN = 60
"""Longest text of a value in a message."""


def shown(value: object) -> str:
    """Short text of a value for a message: whole tables are named by their kind only."""
    if isinstance(value, dict):
        return "{...}"
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "null"
    text = repr(value)
    return text if len(text) <= MAX_SHOWN else text[: MAX_SHOWN - 3] + "..."


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong in one file.

    Args:
        file: the file, as a person would name it.
        key: dotted path of the key; "" is the file as a whole.
        value: text of the value that was found; "" where there is none to show.
        allowed: what would have been accepted, in words.
        line: line of the key in the file, from 1; None where it is not in the file.
    """

    file: str
    key: str
    value: str
    allowed: str
    line: int | None = None

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        if not self.key:
            return f"{place}: {self.allowed}"
        if not self.value:
            return f"{place}: {self.key}: {self.allowed}"
        return f"{place}: {self.key} = {self.value}: {self.allowed}"


class ConfigError(Exception):
    """The configuration cannot be used. `problems` holds all that is wrong, one line each in the text."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))

    def __reduce__(self) -> tuple[type["ConfigError"], tuple[tuple[Problem, ...]]]:
        """As it was made: so it comes whole out of another process."""
        return type(self), (self.problems,)


def single(file: str, key: str, value: object, allowed: str, line: int | None = None) -> ConfigError:
    """A ConfigError with one problem."""
    return ConfigError([Problem(file, key, "" if value is MISSING else shown(value), allowed, line)])


class _Missing:
    """Marks that there is no value to show."""


MISSING = _Missing()
