"""Limit switches at the ends of a joint's travel: where they operate, hysteresis, bounce.

    pressed   at the upper end from q >= u - m + r n on, until q <= u - m - h + r n; at the lower end mirrored
    r n       repeatability: drawn anew each time that the switch has changed
    bounce    for t_b after a change the contact is open or closed by chance, even

u is the limit of the URDF, m how far before it the switch sits, h its differential travel. (Operating point,
differential travel, repeatability, bounce: the words of data sheets of snap-action switches, MIL-PRF-8805.)

Assumption: read at the end of a period; a joint that goes through both points within one has not been there.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams
from sojourn_physics.sensors.truth import require_numbers

ENDS = 2
"""Of a joint: lower, upper."""


class LimitSwitchParams(Params):
    """A switch at each end of the travel of some joints, all alike."""

    before: float = Field(ge=0.0, le=1.0, description="how far before the limit it operates [rad] or [m]")
    hysteresis: float = Field(ge=0.0, le=1.0, description="differential travel until it releases [rad] or [m]")
    repeatability: float = Field(
        default=0.0, ge=0.0, le=0.1, description="standard deviation of where it operates [rad] or [m]"
    )
    bounce_time: float = Field(default=0.0, ge=0.0, le=1.0, description="for which the contact chatters [s]")


@dataclass(frozen=True, eq=False, slots=True)
class LimitSwitchState:
    """Of the switches of n joints, each (n, ENDS): whether pressed, where it operates off its place, time of bounce."""

    pressed: NDArray[np.bool_]
    off: FloatArray
    bouncing: FloatArray
    stream: NoiseStream


def initial_state(params: LimitSwitchParams, seed: int, names: tuple[str, ...], into: FloatArray) -> LimitSwitchState:
    """Switches at rest, each joint's from the stream of its own name.

    Args:
        into: how far the joint is beyond each limit, negative within its travel, (n, ENDS) [rad] or [m].
    """
    stream, row = draw(initial_streams(seed, dict.fromkeys(names, 2 * ENDS)))
    off = params.repeatability * row.reshape(-1, 2, ENDS)[:, 0]
    return LimitSwitchState(into >= off - params.before, off, np.zeros(off.shape), stream)


def step(
    params: LimitSwitchParams, state: LimitSwitchState, into: FloatArray, dt: float
) -> tuple[LimitSwitchState, NDArray[np.bool_]]:
    """Read joints that are so far beyond their limits, (n, ENDS), `dt` [s] after the last time: state and contacts.

    Raises InvalidValueError for an array of another shape or not finite.
    """
    require_numbers("way beyond the limits", into, state.off.shape)
    stream, row = draw(state.stream)
    normal = row.reshape(-1, 2, ENDS)
    operates = state.off - params.before
    pressed = np.where(state.pressed, into > operates - params.hysteresis, into >= operates)
    changed = pressed != state.pressed
    off = np.where(changed, params.repeatability * normal[:, 0], state.off)
    bouncing = np.where(changed, params.bounce_time, np.maximum(state.bouncing - dt, 0.0))
    closed = np.where(bouncing > 0.0, normal[:, 1] > 0.0, pressed)
    return LimitSwitchState(pressed, off, bouncing, stream), closed
