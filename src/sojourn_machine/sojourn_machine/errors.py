"""Errors of values. Every one of them says which quantity was wrong, its value and what is allowed."""

from collections.abc import Sequence

from sojourn_machine.names import names_text


class MachineError(Exception):
    """Base of every error raised by sojourn_machine and by the models that stand on it."""


class InvalidValueError(MachineError, ValueError):
    """A number that a model cannot accept.

    Args:
        name: the quantity, as the caller knows it.
        value: what was given.
        allowed: what would have been accepted, in words.
    """

    def __init__(self, name: str, value: object, allowed: str) -> None:
        self.name = name
        self.value = value
        self.allowed = allowed
        super().__init__(f"{name} = {value!r}: allowed is {allowed}")

    def __reduce__(self) -> tuple[type["InvalidValueError"], tuple[str, object, str]]:
        """As it was made: so it comes out of another process."""
        return type(self), (self.name, self.value, self.allowed)


class UnknownNameError(MachineError, ValueError):
    """A name that nothing is registered under.

    Args:
        thing: what was asked for, in words. name: as it was given. valid: the names that there are.
    """

    def __init__(self, thing: str, name: str, valid: Sequence[str]) -> None:
        self.thing, self.name, self.valid = thing, name, tuple(valid)
        super().__init__(f"{thing} {name!r} is unknown, {names_text(name, self.valid)}")

    def __reduce__(self) -> tuple[type["UnknownNameError"], tuple[str, str, tuple[str, ...]]]:
        """As it was made: so it comes out of another process."""
        return type(self), (self.thing, self.name, self.valid)


class ContestedNameError(UnknownNameError):
    """A name that several packages bring, so that nothing says which is meant.

    Args:
        thing: what was asked for, in words. name: as it was given. claims: what stands for it, at least two.
    """

    def __init__(self, thing: str, name: str, claims: Sequence[str]) -> None:
        super().__init__(thing, name, claims)
        self.args = (f"{thing} {name!r} is brought by {' and by '.join(claims)}: one of them needs another name",)
