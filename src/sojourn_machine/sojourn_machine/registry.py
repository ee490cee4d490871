"""Kinds of a thing that are found by their names: contact laws, and what else is registered by an entry point.

A package adds a kind of its own in its setup.cfg, and no file of this repository changes:

    [options.entry_points]
    sojourn.contact_laws =
        my_law = my_package.my_law:MyLawParams

A kind is imported when it is first asked for, so that a file costs no more than what it names.
"""

from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, TypeVar

from sojourn_machine.errors import UnknownNameError

Kind = TypeVar("Kind")


class Registry(Generic[Kind]):
    """The kinds of one thing.

    Args:
        group: of the entry points. thing: what they are, in words.
    """

    def __init__(self, group: str, thing: str) -> None:
        self.group, self.thing = group, thing
        self._loaded: dict[str, Kind] = {}

    @cached_property
    def _found(self) -> dict[str, EntryPoint]:
        return {point.name: point for point in entry_points(group=self.group)}

    def names(self) -> tuple[str, ...]:
        """Names of all kinds, sorted."""
        return tuple(sorted(self._found))

    def get(self, name: str) -> Kind:
        """The kind of this name. Raises UnknownNameError with the nearest names."""
        if name not in self._loaded:
            if name not in self._found:
                raise UnknownNameError(self.thing, name, self.names())
            self._loaded[name] = self._found[name].load()
        return self._loaded[name]
