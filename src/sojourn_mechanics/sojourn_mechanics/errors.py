"""Errors of the physics. Every one of them says which quantity was wrong, its value and what is allowed."""


class MechanicsError(Exception):
    """Base of every error raised by sojourn_mechanics."""


class InvalidValueError(MechanicsError, ValueError):
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
