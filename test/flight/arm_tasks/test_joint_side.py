"""Servo and encoders behind a gear with play: the integral of a servo might hunt in it."""

from collections.abc import Callable
from typing import Any

import numpy as np

JOINT_SIDE = (
    *(f"arm.drives[{index}].servo.encoder=joint" for index in (0, 1, 2)),
    *(
        f"arm.joint_groups.{group}.encoder.{key}"
        for group in ("arm", "wrist")
        for key in ("side=output", "gear_ratio=1", "bits=20")
    ),
)


def test_an_arm_that_is_measured_behind_its_gears_does_not_hunt_in_their_play(rover_arm: Callable[..., Any]) -> None:
    """In truth, unfolded: every joint stays nearer to where it is to be than a third of the play (0.6 and 0.9 mrad)."""
    rover = rover_arm(*JOINT_SIDE)
    target = np.array(rover.scenario.arm.named_poses["unfold"])
    rows = rover.model.reference_rows(list(rover.scenario.arm.joint_names))
    rover.run(1.0)
    for _ in range(100):
        rover.period()
        assert np.max(np.abs(rover.plant.joints[0][rows] - target)) < 2e-4
