"""Parameters that make no sense are refused with what is allowed."""

from typing import Any

import pytest
from pydantic import ValidationError

from sojourn_flight.arm.params import ArmParams


def test_lists_are_in_joint_order_and_complete(small_values: dict[str, Any]) -> None:
    params = ArmParams(**small_values)
    assert params.joint_count == 5
    assert params.via_poses == ("unfold",)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"max_jerk": (1.0, 1.0)}, "max_jerk has 2 values: allowed is 5"),
        ({"max_velocity": (0.5, 0.5, 0.0, 0.8, 0.8)}, "greater than 0"),
        ({"max_velocity": (0.5, 0.5, float("nan"), 0.8, 0.8)}, "finite"),
        ({"joint_names": ("a", "a", "b", "c", "d")}, "twice"),
        ({"named_poses": {"stow": (0.0,) * 5}}, "unfold"),
        ({"named_poses": {"stow": (0.0,) * 4, "unfold": (0.0,) * 5}}, "named_poses.stow has 4 values"),
        ({"tool_axis": (0.0, 0.0, 2.0)}, "length 2"),
        ({"via_poses": ("ready",)}, "'ready' is not a named pose"),
        ({"coulomb_friction": (1.0,)}, "coulomb_friction has 1 values: allowed is none or 5"),
        ({"colision_clearance": 0.1}, "colision_clearance"),
        ({"collision_step": 0.0}, "greater than 0"),
    ],
)
def test_bad_values_are_refused(small_values: dict[str, Any], change: dict[str, Any], text: str) -> None:
    with pytest.raises(ValidationError, match=text):
        ArmParams(**{**small_values, **change})


def test_parameters_are_frozen(small_values: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        ArmParams(**small_values).collision_step = 0.1
