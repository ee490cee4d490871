"""Values of states as a tree of plain values with their arrays aside, and back: what is kept in files and sent.

Values of our own classes (dataclasses, named tuples, parameters, enumerations) are kept by the name of their class and
of their fields. Nothing of what is read is run: a class is taken only from our own packages and from those that are
installed with kinds of their own (entry points of a group `sojourn.`), and only if its fields are those of the tree.
"""

import base64
import dataclasses
import enum
import importlib
import io
import json
import math
import zipfile
import zlib
from collections.abc import Callable, Mapping
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import IO, Any

import numpy as np
from pydantic import BaseModel

from sojourn_contract.errors import ContractError
from sojourn_contract.unfinished_image import UNFINISHED

TREE = "state.json"
OURS = "sojourn_"
KINDS = "sojourn."
"""Beginning of the groups of entry points by which a package brings kinds of its own."""
PLAIN = (bool, int, float, str)
LARGEST = 1 << 30
"""Bytes that a part of what is kept may have."""


_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    OverflowError,
    RuntimeError,
    EOFError,
)
"""What reading bytes raises that are damaged or altered: RuntimeError of a part that is said to be packed by
what nobody knows, or locked, and of a tree that is too deep; AttributeError of a tree that has a number where it should
branch.
"""
_ARRAY_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


class CheckpointError(ContractError):
    """What is no state of this version, or a state that cannot be kept.

    Args:
        place: where in the state. reason: in words.
    """

    def __init__(self, place: str, reason: str) -> None:
        super().__init__(f"{place}: {reason}")
        self.place, self.reason = place, reason


def packed(value: Any, place: str) -> bytes:
    """A value as bytes. Raises CheckpointError, which names where in `place` there is what cannot be kept."""
    writer, buffer = TreeWriter(), io.BytesIO()
    writer.write(writer.tree(value, place), buffer)
    return buffer.getvalue()


def unpacked(data: bytes, place: str) -> Any:
    """The value that `packed` has made bytes of. Raises CheckpointError for any others."""
    return read_tree(io.BytesIO(data), place, lambda tree, reader: reader.value(tree, place))


def read_tree(file: Path | IO[bytes], place: str, read: Callable[[Any, "TreeReader"], Any]) -> Any:
    """What `read` makes of the tree in a file, and of who knows its arrays. Raises CheckpointError, OSError."""
    try:
        with zipfile.ZipFile(file) as archive:
            for part in archive.infolist():
                if part.file_size > LARGEST:
                    raise CheckpointError(place, f"{part.filename} has {part.file_size} bytes: allowed is {LARGEST}")
            return read(json.loads(archive.read(TREE)), TreeReader(archive))
    except _BROKEN as error:
        raise CheckpointError(place, f"no checkpoint ({error})") from error


class TreeWriter:
    """Makes a tree of plain values; keeps the arrays aside."""

    def __init__(self) -> None:
        self.arrays: dict[str, bytes] = {}

    def write(self, tree: Any, file: Path | IO[bytes]) -> None:
        """Write a tree, and the arrays of all that this has made trees of. Raises OSError."""
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr(TREE, json.dumps(tree))
            for name, data in self.arrays.items():
                archive.writestr(name, data)

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
        (UNFINISHED, lambda self, value, place: self.tree(value.finished(), place)),
        (np.ndarray, _array),
        (enum.Enum, _enum),
        (np.generic, lambda self, value, place: {"number": self.tree(np.asarray(value), place)}),
        (tuple, _tuple),
        (list, lambda self, value, place: {"list": [self.tree(one, f"{place}[{k}]") for k, one in enumerate(value)]}),
        (frozenset, lambda self, value, place: {"set": [self.tree(one, place) for one in sorted(value)]}),
        (bytes, lambda self, value, place: {"bytes": base64.b64encode(value).decode()}),
        (Mapping, _mapping),
    )


class TreeReader:
    """The reverse of `TreeWriter`."""

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
        stream = io.BytesIO(self._archive.read(tree["array"]))
        _check_array(stream, f"{place} ({tree['array']})")
        stream.seek(0)
        return np.load(stream, allow_pickle=False)

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


def _check_array(stream: io.BytesIO, place: str) -> None:
    """Raise CheckpointError where the bytes of an array are not as many as its header says: memory for them would be
    taken before anybody had looked.
    """
    version = np.lib.format.read_magic(stream)
    if version not in _ARRAY_HEADERS:
        raise CheckpointError(
            place, f"an array in format {version}: allowed is {' or '.join(map(str, _ARRAY_HEADERS))}"
        )
    shape, _, dtype = _ARRAY_HEADERS[version](stream)
    size = stream.getbuffer().nbytes - stream.tell()
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != size or dtype.hasobject:
        raise CheckpointError(place, f"{size} bytes: an array of {dtype} {shape} was said to be there")


@cache
def _packages() -> frozenset[str]:
    """Packages that bring kinds."""
    points = (point for package in distributions() for point in package.entry_points)
    return frozenset(point.module.partition(".")[0] for point in points if point.group.startswith(KINDS))


def _is_known(module: str) -> bool:
    """Whether it may hold classes of values. A `__main__` is a program: nothing is read by running one."""
    package, *parts = module.split(".")
    return (package.startswith(OURS) or package in _packages()) and not any(part.startswith("__") for part in parts)


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
