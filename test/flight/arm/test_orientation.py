"""Orientation in every form and back, and where each form fails."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.dh import pose
from sojourn_flight.arm.orientation import (
    from_euler_zyz,
    from_quaternion,
    from_roll_pitch_yaw,
    from_rotation_vector,
    orientation_of,
)
from sojourn_machine.errors import InvalidValueError

ANGLES = st.floats(min_value=-math.pi, max_value=math.pi)


@given(st.tuples(ANGLES, ANGLES, ANGLES))
@example((0.0, -5.960464477539063e-08, 0.0))  # the sign of so small a tilt was lost
@settings(max_examples=100, deadline=None)
def test_every_form_gives_the_rotation_back(angles: tuple[float, float, float]) -> None:
    rotation = pose((0, 0, 0), np.array(angles))[:3, :3]
    form = orientation_of(rotation)
    for matrix in (
        from_quaternion(form.quaternion_xyzw),
        from_rotation_vector(form.rotation_vector),
        from_roll_pitch_yaw(form.roll_pitch_yaw),
        from_euler_zyz(form.euler_zyz),
    ):
        np.testing.assert_allclose(matrix, rotation, atol=1e-7)
    assert form.quaternion_xyzw[3] >= 0.0


def test_known_values() -> None:
    form = orientation_of(from_roll_pitch_yaw(np.array([0.1, 0.2, 0.3])))
    np.testing.assert_allclose(form.roll_pitch_yaw, [0.1, 0.2, 0.3], atol=1e-12)
    assert form.singularities == ()
    quarter = orientation_of(from_rotation_vector(np.array([0.0, 0.0, math.pi / 2])))
    np.testing.assert_allclose(quarter.quaternion_xyzw, [0, 0, math.sqrt(0.5), math.sqrt(0.5)], atol=1e-12)
    assert len(quarter.singularities) == 1 and "Euler ZYZ" in quarter.singularities[0]


@pytest.mark.parametrize(
    ("rpy", "words"),
    [((0.3, math.pi / 2, 0.1), "pitch is a right angle"), ((math.pi, 0.0, 0.0), "rotation vector: half a turn")],
)
def test_singularities_are_told(rpy: tuple[float, float, float], words: str) -> None:
    assert any(words in text for text in orientation_of(from_roll_pitch_yaw(np.array(rpy))).singularities)


def test_what_is_no_rotation_is_refused() -> None:
    for bad in (np.eye(3) * 2.0, -np.eye(3), np.full((3, 3), np.nan), np.eye(2)):
        with pytest.raises(InvalidValueError, match="rotation"):
            orientation_of(bad)
    with pytest.raises(InvalidValueError, match="quaternion"):
        from_quaternion(np.zeros(4))
