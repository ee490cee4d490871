"""What the drive tells of itself once a second, from its state and the commands of the period."""

import math

from sojourn_flight.hazards.camera_watch import in_words
from sojourn_flight.odometry.key_frames import match_status
from sojourn_flight.odometry.visual_state import visual_status
from sojourn_flight.planning.energy_forecast import account_status
from sojourn_flight.supervision.drive_types import DriveState, Pace
from sojourn_flight.supervision.driven_machine import DrivenMachine


def drive_status(machine: DrivenMachine, state: DriveState, pace: Pace) -> dict[str, str | float]:
    """Fields of /drive/status after a period; the unit is the last part of a name."""
    odometry, way, outcome, seen = state.odometry, state.follower, state.last_outcome, state.avoidance
    followed = way if way is not None else outcome
    return {
        **machine.mobility.status(state.mobility, pace.moves, odometry.slip_error),
        "mode": state.mode,
        "phase": way.phase.value if way is not None else "",
        "astern": float(way is not None and way.astern),
        "lateral_error_m": way.lateral_error if way is not None else 0.0,
        "lateral_rms_m": followed.lateral_rms if followed is not None else 0.0,
        "lateral_max_m": followed.lateral_max if followed is not None else 0.0,
        **account_status(state.energy, way.distance_to_go if way is not None else None),
        "waypoint": float(way.index) if way is not None else 0.0,
        "waypoints": float(len(way.goal.points)) if way is not None else 0.0,
        "obstacle": str(seen.obstacle) if seen is not None and seen.obstacle is not None else "",
        "detours": float(seen.detours) if seen is not None else 0.0,
        "distance_m": odometry.distance,
        "speed_m_s": math.hypot(odometry.v_x, odometry.v_y),
        "yaw_rate_rad_s": odometry.yaw_rate,
        "gyro_bias_rad_s": odometry.gyro_bias,
        "heading_sigma_rad": math.sqrt(odometry.covariance[2, 2]),
        "sun": state.heading.text,
        "sun_fixes": float(state.heading.fixes),
        "sun_rejected": float(state.heading.rejected),
        "sun_deviation_sigma": state.heading.deviation,
        **match_status(state.terrain, odometry),
        **visual_status(state.visual, odometry.slip_error),
        "wheel_disagreement_m_s": odometry.residual,
        "yaw_rate_difference_rad_s": odometry.yaw_rate_difference,
        "encoder_jumps": float(odometry.encoder_jumps),
        **({"camera": blindness} if (blindness := in_words(state.camera)) else {}),
        "limit_factor": pace.moves.cut,
        "power_limit": pace.power_limit,
    }
