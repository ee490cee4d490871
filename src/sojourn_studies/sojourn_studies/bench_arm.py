"""Bench of the arms: share of random reachable poses that the inverse kinematics solves, and what one costs."""

import time

import numpy as np

from sojourn_config.arms import load_arm
from sojourn_flight.arm.inverse import pointing_goal, pose_goal
from sojourn_flight.arm.kinematics import forward_kinematics

ARMS = {"explorer_arm": 99.5, "puma560": 99.9, "srms": 99.9, "ssrms": 99.9}
"""Share that must be solved [%]: of the five-joint arm position and pointing, of the others the whole pose."""
MEDIAN_US = 200.0
TARGETS = {
    **{f"inverse kinematics of {name}, solved [%]": (">=", share) for name, share in ARMS.items()},
    **{f"inverse kinematics of {name}, median [us]": ("<=", MEDIAN_US) for name in ARMS},
}


def inverse_kinematics(poses: int) -> dict[str, float]:
    """Figures for poses of joint positions drawn evenly from within the limits; no start is given."""
    figures: dict[str, float] = {}
    for name in ARMS:
        arm, generator = load_arm(name), np.random.default_rng(1)
        solved, times = 0, []
        for _ in range(poses):
            tip = forward_kinematics(arm, generator.uniform(arm.lower, arm.upper))
            begin = time.perf_counter()
            if arm.joint_count == 5:
                answer = pointing_goal(arm, tip.position, tip.tool_direction)
            else:
                answer = pose_goal(arm, tip.position, tip.rotation)
            times.append(time.perf_counter() - begin)
            solved += answer.reached
        figures[f"inverse kinematics of {name}, solved [%]"] = 100.0 * solved / poses
        figures[f"inverse kinematics of {name}, median [us]"] = 1e6 * float(np.median(times))
    return figures
