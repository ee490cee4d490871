"""What is told of the slip estimate: the fields of /drive/status, and wheels that are in trouble, in words."""

import math

import numpy as np

from sojourn_flight.odometry.slip_estimation import SlipModel, SlipState
from sojourn_flight.odometry.slip_params import SlipParams
from sojourn_flight.odometry.speed_filter import FACTOR
from sojourn_machine.params import FloatArray

ALSO = 0.5
"""Part of the time that makes trouble of a wheel, from which others in the same state are named with it [-]."""


def trouble(params: SlipParams, state: SlipState, names: tuple[str, ...]) -> str:
    """Which wheels are in trouble, in words; empty where none is."""

    def named(times: FloatArray, limit: float) -> str:
        if not (times >= limit).any():
            return ""
        return ", ".join(name for name, time in zip(names, times, strict=True) if time >= ALSO * limit)

    found = (
        (f"spinning without headway (slip {float(state.slip.max()):.2f})", state.stuck_for, params.stuck_time),
        ("turning without load", state.idle_for, params.idle_time),
        ("blocked", state.blocked_for, params.stuck_time),
    )
    return "; ".join(f"{text}: {wheels}" for text, times, limit in found if (wheels := named(times, limit)))


def is_stuck(params: SlipParams, state: SlipState) -> bool:
    """Whether a wheel spins without headway."""
    return bool(np.count_nonzero(state.stuck_for >= params.stuck_time))


def further_slip(slip: float, error: float) -> float:
    """The slip of a wheel that gets over ground less than was thought by a part `error` of its way."""
    ground = (1.0 - slip if slip >= 0.0 else 1.0 / max(1.0 + slip, 1e-6)) * (1.0 - error)
    return 1.0 - ground if ground <= 1.0 else 1.0 / ground - 1.0


def slip_status(
    model: SlipModel | None, state: SlipState | None, names: tuple[str, ...], error: float = 0.0
) -> dict[str, str | float]:
    """Fields of /drive/status, slips counted on the rim; none where slip is not estimated.

    Args:
        error: what the camera has found the way to be shorter than that of the estimate, over it [-].
    """
    if model is None or state is None:
        return {}
    tips_over_rim = 1.0 / (1.0 - model.params.free_slip)
    further = 1.0 - (1.0 - error) * tips_over_rim
    status: dict[str, str | float] = {  # exactly 0 is the slip of a wheel that stands
        f"slip_{name}": further_slip(float(slip), further) if slip != 0.0 else 0.0
        for name, slip in zip(names, state.slip, strict=True)
    }
    status["slip"] = further_slip(state.shared, further) if state.observable else 0.0
    status["slip_sigma"] = state.sigma * tips_over_rim
    status["soil_factor"] = float(state.states[FACTOR])
    status["soil_factor_sigma"] = math.sqrt(state.covariance[FACTOR, FACTOR])
    status["wheels_in_trouble"] = trouble(model.params, state, names)
    return status
