"""How fast a planned motion is run: as planned, slower where less power is granted, or not at all in a pause.

The motion keeps to its path (path_clock.py), and to the accelerations that it was planned with: one that was planned
slower, because torque or power would not have been enough, is not paused with more of them. A pause at any moment comes
to rest on the checked path, and resuming goes on with what was planned.
"""

from dataclasses import replace

import numpy as np

from sojourn_mechanics.arm.goals import GoalRefusedError
from sojourn_mechanics.arm.joint_path import JointPath
from sojourn_mechanics.arm.model import ArmModel
from sojourn_mechanics.arm.motion_load import rate_within
from sojourn_mechanics.arm.params import ArmParams
from sojourn_mechanics.arm.path_clock import PathClock, advance, sample
from sojourn_mechanics.arm.state import ArmInput, ArmState
from sojourn_mechanics.arm.trajectory import JointReference

_STILL = 1.0e-9
"""A rate that counts as none [-]."""
_LEAST = 1.0e-6
"""Of an acceleration's limit, for joints that the motion leaves alone [rad/s2 or m/s2]."""


def with_granted_power(params: ArmParams, inputs: ArmInput) -> ArmParams:
    """The parameters with the smaller of the arm's own limits and what is granted: power, and torque by the current."""
    granted = inputs.granted_power
    update: dict[str, float | tuple[float, ...]] = {}
    if granted is not None and (params.power_limit is None or params.power_limit > granted):
        update["power_limit"] = granted
    if inputs.granted_current < 1.0 and params.motor_effort:
        update["motor_effort"] = tuple(inputs.granted_current * effort for effort in params.motor_effort)
    return params.model_copy(update=update) if update else params


def is_granted_as_before(state: ArmState, inputs: ArmInput) -> bool:
    """Whether nothing has changed in what the arm may draw."""
    return (inputs.granted_power, inputs.granted_current) == (state.granted_power, state.granted_current)


def follow_granted_power(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    """Set the pace of the motion under way to what is granted from now on."""
    state = replace(state, granted_power=inputs.granted_power, granted_current=inputs.granted_current)
    if state.path is None or state.stopping:
        return replace(state, pace=1.0)
    pace, holding = 1.0, None
    if inputs.granted_power is not None:
        allowed = with_granted_power(params, inputs)
        pace, holding = rate_within(allowed, model, state.path, state.path_time, inputs.gravity_in_base)
    if pace == 1.0 or holding is None:
        return replace(state, pace=1.0, reason="" if state.pace < 1.0 else state.reason)
    reason = f"slower, at {100.0 * pace:.0f} % of the speed planned: {inputs.granted_power:.1f} W are granted"
    if pace == 0.0:
        reason = f"waits: {inputs.granted_power:.1f} W are granted, and to hold the arm {holding.text}"
    return replace(state, pace=pace, reason=reason)


def pause(state: ArmState) -> ArmState:
    """Begin to come to rest on the path.

    Raises:
        GoalRefusedError: no motion under way, or one that is stopping or paused already.
    """
    if state.path is None or state.stopping:
        raise GoalRefusedError("pause: no motion is under way")
    if state.paused:
        raise GoalRefusedError("pause: the motion is paused already")
    return replace(
        state, paused=True, status="moving", reason="comes to rest on its path", goals_accepted=state.goals_accepted + 1
    )


def resume(state: ArmState) -> ArmState:
    """Go on.

    Raises:
        GoalRefusedError: no motion is paused.
    """
    if state.path is None or not state.paused:
        raise GoalRefusedError("resume: no motion is paused")
    return replace(state, paused=False, status="moving", reason="", goals_accepted=state.goals_accepted + 1)


def go_on_at_rate(state: ArmState, path: JointPath, dt: float) -> ArmState:
    """A period of `dt` [s] on the path, the rate moved towards what is wanted."""
    wanted = 0.0 if state.paused else state.pace
    limits = np.maximum(path.extremes()[3], _LEAST) * (1.0 + _LEAST)
    clock = advance(path, PathClock(state.path_time, state.rate, state.rate_change), wanted, limits, dt)
    reference = JointReference(*sample(path, clock))
    rate = 0.0 if clock.rate < _STILL else 1.0 if clock.rate > 1.0 - _STILL else clock.rate
    state = replace(state, path_time=clock.time, reference=reference, rate=rate, rate_change=clock.change)
    if state.paused and rate == 0.0 and state.status == "moving":
        part = 100.0 * state.path_time / max(path.duration, 1e-9)
        return replace(state, status="paused", reason=f"paused at {part:.0f} % of the way; the task resume goes on")
    return state
