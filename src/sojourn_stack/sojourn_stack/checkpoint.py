"""The state of a run as a file, and back: save it, and go on from it in another process.

The file is a ZIP: `state.json`, a tree of plain values, and its arrays in numpy's own format. Values of our own classes
(dataclasses, named tuples, parameters, enumerations) are kept by the name of their class and of their fields. Nothing
of what is read is run: a class is taken only from our own packages and from those that are installed with kinds of
their own (entry points of a group `sojourn.`), and only if its fields are those of the file.
"""

import base64
import dataclasses
import enum
import importlib
import io
import json
import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from sojourn_contract.leaps import Leaps
from sojourn_stack.errors import StackError
from sojourn_stack.stack import RoleState, StackState

FORMAT = 4
"""Of the file; another one is refused."""
TREE = "state.json"
OURS = "sojourn_"
KINDS = "sojourn."
"""Beginning of the groups of entry points by which a package brings kinds of its own."""
PLAIN = (bool, int, float, str)
LARGEST = 1 << 30
"""Bytes that a part of a checkpoint may have."""


class CheckpointError(StackError):
    """A file that is no checkpoint of this version, or a state that cannot be kept in one.

    Args:
        place: where in the state. reason: in words.
    """

    def __init__(self, place: str, reason: str) -> None:
        super().__init__(f"{place}: {reason}")
        self.place, self.reason = place, reason


@dataclasses.dataclass(frozen=True)
class Origin:
    """Of which run a state is.

    Args:
        scenario: name, or absolute path. overrides: KEY=VALUE texts that went over it. participants: all roles.
        digests: SHA-256 of each file that was read, by name.
    """

    scenario: str
    overrides: tuple[str, ...]
    participants: tuple[str, ...]
    digests: Mapping[str, str]


def save(state: StackState, file: Path, origin: Origin | None = None) -> None:
    """Write a state, and of which run it is.

    Raises:
        CheckpointError: it holds what cannot be kept. OSError: the file cannot be written.
    """
    writer = _Writer()
    roles = {role: writer.tree(one, role) for role, one in state.roles.items()}
    messages = writer.tree(dict(sorted(state.messages.items())), "messages")  # said in another order in each layout
    tree = {
        "format": FORMAT,
        "period": state.period,
        "finished": state.finished,
        "roles": roles,
        "messages": messages,
        "ahead": writer.tree(state.ahead, "ahead"),
        "leaps": writer.tree(state.leaps, "leaps"),
        "origin": writer.tree(origin, "origin"),
    }
    fresh = file.with_name(file.name + ".new")
    with zipfile.ZipFile(fresh, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr(TREE, json.dumps(tree))
        for name, data in writer.arrays.items():
            archive.writestr(name, data)
    fresh.replace(file)


def load(file: Path) -> StackState:
    """Read a state. Raises CheckpointError, which names the role whose state does not fit, for any other file."""
    return read(file)[0]


def read(file: Path) -> tuple[StackState, Origin | None]:
    """Read a state, and of which run it is, None where nobody has said it. Raises as `load`."""
    try:
        with zipfile.ZipFile(file) as archive:
            for part in archive.infolist():
                if part.file_size > LARGEST:
                    reason = f"{part.filename} has {part.file_size} bytes: allowed is {LARGEST}"
                    raise CheckpointError(str(file), reason)
            tree = json.loads(archive.read(TREE))
            found = tree.get("format") if isinstance(tree, dict) else None
            if found != FORMAT:
                raise CheckpointError(str(file), f"format {found!r}: allowed is {FORMAT}")
            reader = _Reader(archive)
            roles = {role: reader.value(one, role) for role, one in tree["roles"].items()}
            for role, one in roles.items():
                if not isinstance(one, RoleState):
                    raise CheckpointError(role, f"a {type(one).__name__}: allowed is the state of a role")
            messages = reader.value(tree["messages"], "messages")
            ahead, leaps = (reader.value(tree[part], part) for part in ("ahead", "leaps"))
            if not isinstance(leaps, Leaps):
                raise CheckpointError("leaps", f"a {type(leaps).__name__}: allowed is the leaps of the clock")
            state = StackState(int(tree["period"]), roles, messages, bool(tree["finished"]), ahead, leaps)
            origin = reader.value(tree["origin"], "origin")
            if origin is not None and not isinstance(origin, Origin):
                raise CheckpointError("origin", f"a {type(origin).__name__}: allowed is of which run it is")
            return state, origin
    except (zipfile.BadZipFile, KeyError, ValueError, TypeError, RecursionError, EOFError) as error:
        raise CheckpointError(str(file), f"no checkpoint ({error})") from error


class _Writer:
    """Makes a tree of plain values; keeps the arrays aside."""

    def __init__(self) -> None:
        self.arrays: dict[str, bytes] = {}

    def tree(self, value: Any, place: str) -> Any:
        """A value at a place of the state as plain values."""
        if value is None or type(value) in PLAIN:
            return value
        for kind, write in self._writers:
            if isinstance(value, kind):
                return write(self, value, place)
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            names = [one.name for one in dataclasses.fields(value)]
            return {"class": _name(value, place), "fields": self._fields(value, names, place)}
        if isinstance(value, BaseModel):
            return {"class": _name(value, place), "fields": self._fields(value, list(type(value).model_fields), place)}
        raise CheckpointError(place, f"a {type(value).__module__}.{type(value).__name__} cannot be kept")

    def _fields(self, value: Any, names: list[str], place: str) -> dict[str, Any]:
        return {name: self.tree(getattr(value, name), f"{place}.{name}") for name in names}

    def _array(self, value: Any, place: str) -> Any:
        if value.dtype.hasobject:
            raise CheckpointError(place, "an array of objects cannot be kept")
        name = f"{len(self.arrays)}.npy"
        buffer = io.BytesIO()
        np.save(buffer, value, allow_pickle=False)
        self.arrays[name] = buffer.getvalue()
        return {"array": name}

    def _enum(self, value: Any, place: str) -> Any:
        return {"member": value.name, "of": _name(value, place)}

    def _tuple(self, value: Any, place: str) -> Any:
        if hasattr(value, "_fields"):
            return {"class": _name(value, place), "fields": self._fields(value, list(value._fields), place)}
        return {"tuple": [self.tree(one, f"{place}[{k}]") for k, one in enumerate(value)]}

    def _mapping(self, value: Any, place: str) -> Any:
        return {"map": [[self.tree(k, place), self.tree(one, f"{place}[{k!r}]")] for k, one in value.items()]}

    _writers: tuple[tuple[Any, Callable[..., Any]], ...] = (
        (np.ndarray, _array),
        (enum.Enum, _enum),
        (np.generic, lambda self, value, place: {"number": self.tree(np.asarray(value), place)}),
        (tuple, _tuple),
        (list, lambda self, value, place: {"list": [self.tree(one, f"{place}[{k}]") for k, one in enumerate(value)]}),
        (frozenset, lambda self, value, place: {"set": [self.tree(one, place) for one in sorted(value)]}),
        (bytes, lambda self, value, place: {"bytes": base64.b64encode(value).decode()}),
        (Mapping, _mapping),
    )


class _Reader:
    """The reverse of `_Writer`."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive

    def value(self, tree: Any, place: str) -> Any:
        """A value at a place of the state."""
        if not isinstance(tree, dict):
            if tree is None or isinstance(tree, bool | str | int | float):
                return tree
            raise CheckpointError(place, f"a {type(tree).__name__} in a checkpoint")
        if "class" in tree:
            return self._made(_class(tree["class"], place), tree["fields"], place)
        for key, read in self._readers.items():
            if key in tree:
                return read(self, tree, place)
        raise CheckpointError(place, f"{', '.join(map(str, tree))[:80]} stands for nothing")

    def _made(self, kind: Any, fields: Mapping[str, Any], place: str) -> Any:
        """A value of one of our classes, without its constructor: what was valid is valid."""
        is_tuple, is_params = issubclass(kind, tuple), issubclass(kind, BaseModel)
        if is_params:
            wanted = list(kind.model_fields)
        else:
            wanted = list(kind._fields) if is_tuple else [one.name for one in dataclasses.fields(kind)]
        if set(wanted) != set(fields):
            unlike = ", ".join(sorted(set(wanted) ^ set(fields)))
            raise CheckpointError(place, f"a {kind.__name__} of another version: it differs in {unlike}")
        values = {name: self.value(fields[name], f"{place}.{name}") for name in wanted}
        if is_params:
            return kind.model_construct(**values)
        if is_tuple:
            return kind(**values)
        made = object.__new__(kind)
        for name, value in values.items():
            object.__setattr__(made, name, value)
        return made

    def _array(self, tree: Any, place: str) -> Any:
        return np.load(io.BytesIO(self._archive.read(tree["array"])), allow_pickle=False)

    def _member(self, tree: Any, place: str) -> Any:
        return _class(tree["of"], place)[tree["member"]]

    def _map(self, tree: Any, place: str) -> Any:
        return {self.value(k, place): self.value(one, f"{place}[{k!r}]") for k, one in tree["map"]}

    _readers: Mapping[str, Callable[..., Any]] = {
        "array": _array,
        "member": _member,
        "number": lambda self, tree, place: self.value(tree["number"], place)[()],
        "tuple": lambda self, tree, place: tuple(self.value(one, place) for one in tree["tuple"]),
        "list": lambda self, tree, place: [self.value(one, place) for one in tree["list"]],
        "set": lambda self, tree, place: frozenset(self.value(one, place) for one in tree["set"]),
        "bytes": lambda self, tree, place: base64.b64decode(tree["bytes"]),
        "map": _map,
    }


@cache
def _packages() -> frozenset[str]:
    """Packages that bring kinds."""
    points = (point for package in distributions() for point in package.entry_points)
    return frozenset(point.module.partition(".")[0] for point in points if point.group.startswith(KINDS))


def _is_known(module: str) -> bool:
    return module.startswith(OURS) or module.partition(".")[0] in _packages()


def _name(value: Any, place: str) -> str:
    """Of the class of a value, one that `_class` takes."""
    kind = type(value)
    if not _is_known(kind.__module__) or "<" in kind.__qualname__:
        raise CheckpointError(place, f"a {kind.__module__}.{kind.__qualname__} cannot be kept")
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str, place: str) -> Any:
    """A class by its name. Raises CheckpointError where there is none, or it is not for values."""
    module, _, qualified = name.partition(":")
    if not _is_known(module):
        raise CheckpointError(place, f"a class of {module}: allowed is one of ours, or of a package with kinds of ours")
    try:
        found: Any = importlib.import_module(module)
        for part in qualified.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError) as error:
        raise CheckpointError(place, f"there is no {name} any more") from error
    values = isinstance(found, type) and (
        dataclasses.is_dataclass(found) or issubclass(found, enum.Enum | BaseModel) or hasattr(found, "_fields")
    )
    if not values:
        raise CheckpointError(place, f"{name} is no class of values")
    return found
