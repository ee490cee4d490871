"""Friction brake on a shaft: holding torque, delays of closing and opening, heat.

    closed share s: s' = 1/t_close towards 1 when asked to close, 1/t_open towards 0
    while it turns   T = s T_b (m_k/m_s) against the motion;   at rest it holds any torque up to s T_b
    within a step the brake stops the motion and does not turn it round (friction as an impulse with a bound: Moreau
    1988) heat Q' = T w
Assumptions: torque independent of rate and temperature. Range: any step; power-off brakes (holding without current) are
closed when not asked to open.
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import Params


class BrakeParams(Params):
    """A brake."""

    holding_torque: float = Field(gt=0.0, le=1e6, description="T_b, at rest [N m]")
    sliding_ratio: float = Field(default=0.85, gt=0.0, le=1.0, description="sliding over holding torque [-]")
    closing_time: float = Field(default=0.02, ge=0.0, le=10.0, description="t_close [s]")
    opening_time: float = Field(default=0.03, ge=0.0, le=10.0, description="t_open [s]")


class BrakeState(NamedTuple):
    """Closed share 0..1 [-] and heat made so far [J]."""

    closed: float = 1.0
    heat: float = 0.0


def step_brake(
    brake: BrakeParams, state: BrakeState, close: bool, rate: float, torque: float, inertia: float, dt: float
) -> tuple[BrakeState, float]:
    """State after dt [s] and new rate of the shaft [rad/s].

    Args:
        close: what the brake is asked for. rate: of the shaft [rad/s]. torque: of all others on it [N m].
        inertia: of the shaft and what it drives [kg m^2].
    """
    for name, value in (("rate", rate), ("torque", torque)):
        if not math.isfinite(value):
            raise InvalidValueError(name, value, "a finite number")
    if not (inertia > 0.0 and dt > 0.0):
        raise InvalidValueError("inertia, dt", (inertia, dt), "more than 0")
    span = brake.closing_time if close else brake.opening_time
    change = 1.0 if span == 0.0 else dt / span
    closed = min(max(state.closed + (change if close else -change), 0.0), 1.0)
    free = rate + dt * torque / inertia
    # at rest the larger torque holds; a shaft that moves meets the sliding one
    share = 1.0 if rate == 0.0 else brake.sliding_ratio
    limit = closed * brake.holding_torque * share
    if rate == 0.0 and abs(torque) > limit:
        limit *= brake.sliding_ratio
    new = math.copysign(max(abs(free) - dt * limit / inertia, 0.0), free)
    if rate * free < 0.0 and abs(torque) <= closed * brake.holding_torque:
        new = 0.0  # it came to rest on the way, and the brake holds it there
    used = inertia * abs(free - new) / dt
    heat = state.heat + used * 0.5 * abs(rate + new) * dt
    return BrakeState(closed, heat), new
