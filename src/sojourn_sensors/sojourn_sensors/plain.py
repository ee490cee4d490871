"""States and readings as JSON has them, and back by the form of a usual one, which judges what was read."""

import dataclasses
from collections.abc import Mapping
from math import isfinite
from typing import Any

import numpy as np

from sojourn_machine.params import FloatArray

LARGEST = 20_000
"""Numbers that an array may have which is kept several times a second: a cloud, but no image."""
PLAIN = (bool, int, float, str)


def plain(value: Any) -> Any:
    """Arrays, mappings, tuples, dataclasses and plain values as JSON has them. Raises TypeError for all else."""
    if value is None or isinstance(value, PLAIN):
        return value
    if isinstance(value, np.ndarray) and value.size <= LARGEST:
        return value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, tuple):
        return [plain(one) for one in value]
    if dataclasses.is_dataclass(value):
        return [plain(getattr(value, one.name)) for one in dataclasses.fields(value)]
    raise TypeError(f"a {type(value).__name__} is not kept")


def like(usual: Any, value: Any, is_reading: bool = False) -> Any:
    """What `plain` has made JSON of, with classes and names as in a usual one; in place of None any plain value.

    Args:
        is_reading: numbers need not be finite, and arrays may have other many rows; those of a state not.

    Raises:
        TypeError, ValueError: it is of another form.
    """
    if usual is None or isinstance(usual, PLAIN):
        return _plain_like(usual, value, is_reading)
    if isinstance(usual, np.ndarray):
        return _array_like(usual, value, is_reading)
    if isinstance(usual, Mapping):
        if value.keys() != usual.keys():
            raise ValueError(value.keys())
        return {name: like(one, value[name], is_reading) for name, one in usual.items()}
    is_tuple = isinstance(usual, tuple)
    parts = usual if is_tuple else [getattr(usual, one.name) for one in dataclasses.fields(usual)]
    found = [like(one, each, is_reading) for one, each in zip(parts, value, strict=True)]
    return tuple(found) if is_tuple and not hasattr(usual, "_fields") else type(usual)(*found)


def _plain_like(usual: Any, value: Any, is_reading: bool) -> Any:
    kinds = PLAIN if usual is None else tuple(kind for kind in PLAIN if isinstance(usual, kind))
    if not (isinstance(value, kinds) or usual is value is None):
        raise TypeError(type(value))
    if isinstance(value, float) and not (is_reading or isfinite(value)):
        raise ValueError(value)
    return value


def _array_like(usual: FloatArray, value: Any, is_reading: bool) -> FloatArray:
    found = np.array(value, dtype=usual.dtype)
    rows = found.shape[1:] == usual.shape[1:] and found.ndim == usual.ndim
    if not (rows if is_reading else found.shape == usual.shape and np.isfinite(found).all()):
        raise ValueError(found.shape)
    return found
