"""Checks of the drives' parameters, and what follows from them."""

from typing import Any

import pytest
from pydantic import ValidationError

from sojourn_machine.drives import JointDriveParams

GOOD: dict[str, Any] = {
    "joints": ["a", "b"],
    "load": "drive",
    "motor": {
        "resistance": 2.32,
        "torque_constant": 0.0234,
        "rotor_inertia": 1.08e-6,
        "no_load_current": 0.0369,
        "max_current": 2.0,
    },
    "gear": {"ratio": 1000.0, "efficiency": 0.7, "friction_torque": 2.5, "viscous_friction": 1.0},
    "servo": {"mode": "rate", "proportional": 100.0, "max_torque": 40.0},
}


def test_what_the_joint_feels() -> None:
    drive = JointDriveParams.model_validate(GOOD)
    assert drive.reflected_inertia == pytest.approx(1.08)
    assert drive.friction_torque == pytest.approx(2.5 + 0.0369 * 23.4)


@pytest.mark.parametrize(
    ("part", "change", "words"),
    [
        ("motor", {"resistance": 0.0}, "resistance"),
        ("motor", {"torque_constant": float("nan")}, "torque_constant"),
        ("gear", {"efficiency": 1.01}, "efficiency"),
        ("gear", {"ratio": 0.5}, "ratio"),
        ("gear", {"rattio": 10.0}, "rattio"),
        ("servo", {"mode": "speed"}, "mode"),
        ("servo", {"mode": "position"}, "derivative"),
        ("servo", {"max_torque": float("inf")}, "max_torque"),
    ],
)
def test_what_is_refused(part: str, change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        JointDriveParams.model_validate({**GOOD, part: {**GOOD[part], **change}})


def test_a_joint_named_twice_is_refused() -> None:
    with pytest.raises(ValidationError, match="each joint once"):
        JointDriveParams.model_validate({**GOOD, "joints": ["a", "a"]})
