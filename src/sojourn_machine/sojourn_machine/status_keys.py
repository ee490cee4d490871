"""What our own drive, arm and power manager say in their statuses, so that a slip of the pen is found before anybody
waits for it in vain.

A role may be somebody else's and say more than ours: the contract fixes no key but state, goal_stamp and reason. So a
key is refused where it looks like one of these and is none. The states of goals are fixed.
"""

import re
from difflib import get_close_matches
from typing import Literal, TypeAlias, get_args

GoalState: TypeAlias = Literal["idle", "moving", "reached", "refused", "stopped", "failed"]
"""What /drive/status and /arm/status may say of a goal."""
GOAL_STATES: tuple[str, ...] = get_args(GoalState)
_GOAL = ("state", "goal_stamp", "reason", "level", "message")
KEYS: dict[str, tuple[str, ...]] = {
    "/drive/status": (
        *_GOAL, "distance_to_go", "missing_inputs", "mode", "phase", "astern", "lateral_error_m", "lateral_rms_m",
        "lateral_max_m", "energy_forecast_wh", "energy_used_wh", "energy_to_go_wh", "waypoint", "waypoints", "obstacle",
        "detours", "distance_m", "speed_m_s", "yaw_rate_rad_s", "gyro_bias_rad_s", "heading_sigma_rad", "sun",
        "sun_fixes", "sun_rejected", "sun_deviation_sigma", "terrain_match", "terrain_matches", "terrain_rejected",
        "terrain_key_frames", "terrain_points", "terrain_deviation_sigma", "terrain_slip_correction", "visual_odometry",
        "visual_matches", "visual_rejected", "visual_points", "visual_error_px", "visual_deviation_sigma",
        "visual_slip", "visual_slip_correction", "wheel_disagreement_m_s", "yaw_rate_difference_rad_s",
        "encoder_jumps", "camera", "limit_factor", "power_limit", "slip", "slip_sigma", "soil_factor",
        "soil_factor_sigma", "wheels_in_trouble", "failed_motors", "steer_error_rad", "steering_residual_m_s",
        "speed_factor", "asked_stamp", "asked_state", "asked_reason", "asked_length_m", "asked_time_s",
        "asked_energy_wh", "asked_charge_at_end", "asked_seen", "asked_tilt", "asked_tilt_margin_deg", "placed_stamp",
        "placed_state", "placed_reason",
    ),
    "/arm/status": (
        *_GOAL, "progress", "time_to_go", "error_m", "joint_error_rad", "tip_in_base_m", "goals_accepted",
        "goals_refused", "failed_joints", "task", "base_moved_m", "base_turned_deg", "corrections", "bias_force_n",
        "bias_moment_nm", "bit_temperature_k", "contact_force_n", "depth_m", "grasp_n", "opening_m", "overshoot_m",
        "overshoot_n", "payload_by_wrist_kg", "payload_deviation_kg", "payload_kg", "peak_drag_n", "peak_force_n",
        "rms_error_n", "specific_energy_j_m3", "torque_nm", "work_j", "worst_error_n",
    ),
    "/power/status": (
        "state", "reason", "level", "message", "mode", "mode_reason", "soc", "energy_remaining_wh", "time_to_empty_s",
        "drive_fraction", "correcting", "shed", "soc_sigma", "capacity_factor", "capacity_sigma", "current_offset_a",
        "faults", "forecast", "arrays_clean", "held_at_rest_w", "request", "request_stamp", "request_state",
        "request_reason",
    ),
}  # fmt: skip
"""Of each status what it says, always or where there is cause."""
_OF_ONE_OF_SEVERAL = re.compile(r"slip_\w+|(?P<key>\w+)_\d+")
"""A wheel's slip, by its name; what is said of a further store, by its number."""
_LIKE, _LIKE_TOPIC = 0.7, 0.9
"""From what likeness on another key is meant, or another topic (`difflib`): 0.8 for one letter of five. The topics of
statuses end alike, and another's may well be named /grip/status.
"""


def topics_meant(topic: str) -> list[str]:
    """Status topics of ours that somebody means who writes one that is none; empty where it is one, or like none."""
    return [] if topic in KEYS else get_close_matches(topic, KEYS, cutoff=_LIKE_TOPIC)


def keys_meant(topic: str, key: str) -> list[str]:
    """Keys of a status that somebody means who writes one that is none of them; empty where it is one, or like none."""
    known = KEYS.get(topic, ())
    several = _OF_ONE_OF_SEVERAL.fullmatch(key)
    if key in known or (several is not None and several["key"] in (None, *known)):
        return []
    return get_close_matches(key, known, cutoff=_LIKE)
