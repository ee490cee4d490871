"""When the rover may drive: where the arm is, and whether it stands still."""

import numpy as np
import pytest

from sojourn_flight.arm.interlock import InterlockParams, why_not_to_drive

POSES = {"stow": (1.5, 0.0), "carry": (0.0, 1.0), "unfold": (0.0, 0.0)}
NAMES = ("shoulder", "elbow")
STILL = np.zeros(2)


def why(params: InterlockParams, at: tuple[float, float], rate: float = 0.0, driving: bool = False) -> str:
    return why_not_to_drive(params, POSES, NAMES, np.array(at), np.array([0.0, rate]), driving)


def test_it_drives_at_its_driving_poses_alone() -> None:
    params = InterlockParams(driving_poses=("stow", "carry"), tolerance=0.05)
    assert why(params, (1.54, -0.04)) == "" and why(params, (0.0, 1.0)) == ""
    reason = why(params, (1.5, -0.3))
    assert "elbow is 0.30 from 'stow'" in reason and "'stow' or 'carry'" in reason
    assert "shoulder is 0.10 from 'carry'" in why(params, (0.1, 1.0))
    assert why(params, (0.0, 0.0)) != ""


def test_an_arm_that_moves_keeps_it_from_starting_but_one_that_shakes_does_not_stop_it() -> None:
    params = InterlockParams(still_speed=0.03)
    assert why(params, (1.5, 0.0), rate=0.02) == ""
    assert why(params, (1.5, 0.0), rate=-0.1) == "the arm moves: elbow at -0.10 rad/s (m/s where it slides)"
    assert why(params, (1.5, 0.0), rate=-0.1, driving=True) == ""


@pytest.mark.parametrize("params", [InterlockParams(enabled=False), InterlockParams(driving_poses=())])
def test_it_can_be_switched_off(params: InterlockParams) -> None:
    assert why_not_to_drive(params, POSES, NAMES, np.array([9.0, 9.0]), STILL, False) == ""
