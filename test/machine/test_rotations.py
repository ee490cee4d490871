"""Quaternions of rotation matrices, and that none of them leaves memory behind."""

import ctypes
import gc
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_drive.reports import orientation
from sojourn_machine.rotations import quaternion_of

CALLS = 5000
angles = st.floats(-3.2, 3.2)


class _Heap(ctypes.Structure):
    """What mallinfo2(3) tells."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "fordblks",
            "keep",
        )
    ]


def left_behind(call: Callable[[], object]) -> float:
    """Bytes of the heap that one call keeps for good."""
    library = ctypes.CDLL(None)
    if not hasattr(library, "mallinfo2"):
        pytest.skip("the C library does not tell what is used of its heap")
    library.mallinfo2.restype = _Heap
    call()
    gc.collect()
    before = library.mallinfo2().uordblks
    for _ in range(CALLS):
        call()
    gc.collect()
    return float(library.mallinfo2().uordblks - before) / CALLS


@given(angles, angles, angles)
def test_they_are_those_of_the_library(roll: float, pitch: float, yaw: float) -> None:
    rotation = pin.rpy.rpyToMatrix(roll, pitch, yaw)
    quaternion = quaternion_of(rotation)
    assert np.array_equal(quaternion, pin.Quaternion(rotation).coeffs())
    assert pin.Quaternion(quaternion).toRotationMatrix() == pytest.approx(rotation, abs=1e-12)


def test_neither_they_nor_what_the_drive_tells_with_them_leaves_anything_behind() -> None:
    rotation = pin.rpy.rpyToMatrix(0.1, 0.2, 0.3)
    estimate: Any = SimpleNamespace(roll=0.1, pitch=-0.05, yaw=2.0)
    assert left_behind(lambda: quaternion_of(rotation)) < 20.0
    assert left_behind(lambda: orientation(estimate)) < 20.0
