"""Whether two states are of one structure: the same classes, names, lengths and shapes, whatever their values; and
whether a run that begins with the one may come to the other.

Kernels take the arrays of a state as they are: one of another shape would be read beyond its end.
"""

import dataclasses
import enum
from collections.abc import Iterator, Mapping
from numbers import Number
from typing import Any

import numpy as np
from pydantic import BaseModel

from sojourn_contract.unfinished_image import finished


def difference(one: Any, other: Any, place: str) -> str:
    """The first difference in structure of two values at a place of the state, in words; empty where there is none."""
    one, other = finished(one), finished(other)
    if type(one) is not type(other):
        return f"{place}: a {type(one).__name__} in the one, a {type(other).__name__} in the other"
    if isinstance(one, np.ndarray):
        same = one.shape == other.shape and one.dtype == other.dtype
        return "" if same else f"{place}: {one.dtype} {one.shape} in the one, {other.dtype} {other.shape} in the other"
    parts, others = dict(_parts(one)), dict(_parts(other))
    unlike = sorted(set(parts) ^ set(others))
    if unlike:
        return f"{place}: {unlike[0]} is in one of them alone"
    return next((found for key in parts if (found := difference(parts[key], others[key], f"{place}{key}"))), "")


def misfit(first: Any, later: Any, place: str, is_fixed: bool = True) -> str:
    """The first place at which a value of a run cannot have come from that with which the run begins, in words; empty
    where there is none.

    What may come and go does: None, values of another class of ours, what is in mappings and lists, and in tuples of
    another length. is_fixed: whether an array keeps its shape, as each does that has a name of its own.
    """
    first, later = finished(first), finished(later)
    if first is None or later is None:
        return ""
    kinds = _kind(first), _kind(later)
    if kinds[0] is not kinds[1]:
        return f"{place}: a {type(later).__name__}, and the run begins with a {type(first).__name__}"
    if isinstance(first, np.ndarray):
        same = first.dtype == later.dtype and (first.shape == later.shape if is_fixed else first.ndim == later.ndim)
        told = (f"{one.dtype} {one.shape}" for one in (later, first))
        return "" if same else f"{place}: {' and the run begins with '.join(told)}"
    if type(first) is not type(later) or isinstance(first, Mapping | list):
        return ""
    parts, others = dict(_parts(first)), dict(_parts(later))
    if set(parts) != set(others):
        return ""
    is_named = kinds[0] is not tuple
    return next((found for key in parts if (found := misfit(parts[key], others[key], place + key, is_named))), "")


def _kind(value: Any) -> type:
    """What cannot stand for another: a number, a text, an array, a sequence, or a value of a class of ours."""
    plain = (np.ndarray, str, Mapping, list)
    if isinstance(value, Number | np.generic) and not isinstance(value, enum.Enum):
        return Number
    found = next((kind for kind in plain if isinstance(value, kind)), object)
    return tuple if isinstance(value, tuple) and not hasattr(value, "_fields") else found


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    """What a value consists of, each with its name; nothing of a plain one."""
    if dataclasses.is_dataclass(value):
        yield from ((f".{one.name}", getattr(value, one.name)) for one in dataclasses.fields(value))
    elif isinstance(value, BaseModel):
        yield from ((f".{name}", getattr(value, name)) for name in type(value).model_fields)
    elif isinstance(value, tuple) and hasattr(value, "_fields"):
        yield from ((f".{name}", getattr(value, name)) for name in value._fields)
    elif isinstance(value, tuple | list):
        yield from ((f"[{index}]", one) for index, one in enumerate(value))
    elif isinstance(value, Mapping):
        yield from ((f"[{key!r}]", one) for key, one in value.items())
