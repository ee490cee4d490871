"""Whether two states are of one structure: the same classes, names, lengths and shapes, whatever their values.

Kernels take the arrays of a state as they are: one of another shape would be read beyond its end.
"""

import dataclasses
from collections.abc import Iterator, Mapping
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
