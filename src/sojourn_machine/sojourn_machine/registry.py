"""Kinds of a thing that are found by their names: contact laws, and what else is registered by an entry point.

A package adds a kind of its own in its setup.cfg, and no file of this repository changes:

    [options.entry_points]
    sojourn.contact_laws =
        my_law = my_package.my_law:MyLawParams

A kind is imported when it is first asked for, so that a file costs no more than what it names.

A kind from outside stands before one of Sojourn's own of the same name: what Sojourn learns to do later takes nothing
from a package that was there before. Two from outside under one name are refused.
"""

from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, TypeVar

from sojourn_machine.errors import ContestedNameError, UnknownNameError

Kind = TypeVar("Kind")
OWN = "sojourn_"
"""How the names of Sojourn's own packages begin."""


class Registry(Generic[Kind]):
    """The kinds of one thing.

    Args:
        group: of the entry points. thing: what they are, in words.
    """

    def __init__(self, group: str, thing: str) -> None:
        self.group, self.thing = group, thing
        self._loaded: dict[str, Kind] = {}

    @cached_property
    def _found(self) -> dict[str, dict[str, EntryPoint]]:
        """Of each name those that stand for it, by what they point to: one, unless packages contradict each other."""
        found: dict[str, dict[str, EntryPoint]] = {}
        for point in entry_points(group=self.group):
            found.setdefault(point.name, {})[point.value] = point
        for points in found.values():
            foreign = [value for value in points if not value.startswith(OWN)]
            for value in list(points):
                if foreign and value not in foreign:
                    del points[value]
        return found

    def names(self) -> tuple[str, ...]:
        """Names of all kinds, sorted."""
        return tuple(sorted(self._found))

    def get(self, name: str) -> Kind:
        """The kind of this name.

        Raises:
            UnknownNameError: there is none; with the nearest names.
            ContestedNameError: two packages bring one.
        """
        if name not in self._loaded:
            if name not in self._found:
                raise UnknownNameError(self.thing, name, self.names())
            point, *others = self._found[name].values()
            if others:
                raise ContestedNameError(self.thing, name, sorted(self._found[name]))
            self._loaded[name] = point.load()
        return self._loaded[name]
