"""Gears under power in both directions, self-locking, and backlash.

    motor drives     T_out = n_f N T_in        back-driven   T_in = n_b T_out / N
    one loss T_l of the same size in both senses gives  n_b = 2 - 1/n_f:  a gear with n_f <= 1/2 locks itself
    (Giberti, Cinquemani and Legnani 2010; Wang 1996; stages multiply)
    backlash 2 h: play operator (output follows when the gap is closed), torque of a dead-band spring
        T = k (x - h) + c x' for x > h,  k (x + h) + c x' for x < -h,  0 between; a flank pushes, it does not pull
Assumptions: losses in proportion to the torque, besides the friction of `GearParams`. Range: n_f from more than 0 to 1.
"""

import math
from collections.abc import Sequence

from sojourn_mechanics.errors import InvalidValueError


def backward_efficiency(forward: float) -> float:
    """n_b for n_f [-]; 0 where the gear locks itself."""
    if not 0.0 < forward <= 1.0:
        raise InvalidValueError("forward", forward, "more than 0, at most 1")
    return max(2.0 - 1.0 / forward, 0.0)


def is_back_drivable(forward: float) -> bool:
    """Whether a torque at the output can turn the input at all."""
    return backward_efficiency(forward) > 0.0


def stages(efficiencies: Sequence[float]) -> tuple[float, float]:
    """n_f and n_b of stages in series [-]: each locks by itself, so n_b is a product too."""
    forward, backward = 1.0, 1.0
    for efficiency in efficiencies:
        backward *= backward_efficiency(efficiency)
        forward *= efficiency
    return forward, backward


def output_torque(torque: float, rate: float, ratio: float, forward: float, backward: float) -> float:
    """Torque at the output [N m] for one at the input [N m], turning at a rate of the input [rad/s].

    Power flows to the output where torque and rate of the input have one sign. Back-driven, the output has to bring
    ratio/n_b times the input's torque; a locking gear (n_b = 0) cannot turn so.

    Raises:
        InvalidValueError: a locking gear that is turned from its output.
    """
    if torque * rate >= 0.0:
        return torque * ratio * forward
    if backward <= 0.0:
        raise InvalidValueError("rate", rate, "0 for a gear that locks itself and is loaded from its output")
    return torque * ratio / backward


def play(position: float, output: float, half_gap: float) -> float:
    """Output after the input has moved to `position`: it stays inside of the gap, and is carried along by its
    flanks.
    """
    if not (math.isfinite(position) and half_gap >= 0.0):
        raise InvalidValueError("position, half_gap", (position, half_gap), "finite, at least 0")
    return min(max(output, position - half_gap), position + half_gap)


def dead_band_torque(twist: float, twist_rate: float, half_gap: float, stiffness: float, damping: float) -> float:
    """Torque [N m] through teeth with backlash for a twist [rad] and its rate [rad/s]."""
    if twist > half_gap:
        return max(stiffness * (twist - half_gap) + damping * twist_rate, 0.0)
    if twist < -half_gap:
        return min(stiffness * (twist + half_gap) + damping * twist_rate, 0.0)
    return 0.0
