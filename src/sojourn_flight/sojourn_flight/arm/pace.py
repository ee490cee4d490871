"""How fast a motion is run: as planned, slower where less power is granted, or not at all in a pause.

The motion keeps to its path (path_clock.py), and to the accelerations and jerks that it was planned with: one that was
planned slower, because torque or power would not have been enough, is not paused with more of them. A pause at any
moment comes to rest on the checked path, and resuming goes on with what was planned.

Of a guided motion, the velocity that a task wants is made smaller at every period: gravity, friction and the contact
are counted, the inertia of its slow changes is not.
"""

from dataclasses import replace

import numpy as np

from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.motion_load import rate_within, share_within
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.path_clock import ClockLimits, PathClock, advance, sample
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, ArmState
from sojourn_flight.arm.tasks.tip_motion import TipMotion, rates_of
from sojourn_flight.arm.trajectory import JointReference
from sojourn_machine.params import FloatArray

_STILL = 1.0e-9
"""A rate that counts as none [-]."""
_ROUNDING = 1.0 + 1.0e-6


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
    pace, holding = 1.0, ""
    if inputs.granted_power is not None:
        allowed = with_granted_power(params, inputs)
        pace, peak = rate_within(allowed, model, state.path, state.path_time, inputs.gravity_in_base)
        holding = peak.text
    if pace == 1.0:
        return replace(state, pace=1.0, reason="" if state.pace < 1.0 else state.reason)
    return replace(state, pace=pace, reason=_slower(pace, inputs, holding))


def granted_velocity(
    params: ArmParams, model: ArmModel, inputs: ArmInput, motion: TipMotion, wanted: FloatArray, force: FloatArray
) -> tuple[float, str]:
    """The share of a wanted velocity of the tip that what is granted allows, and why it is less than 1, in words.

    Args:
        wanted: (3,) [m/s]. force: of the ground on the tool in base_link (3,) [N].
    """
    if inputs.granted_power is None:
        return 1.0, ""
    positions = motion.joints.position
    contact = -forward_kinematics(model, positions).jacobian[:3].T @ force
    allowed, rates = with_granted_power(params, inputs), rates_of(model, motion, wanted)
    share, asked = share_within(allowed, model, positions, rates, contact, inputs.gravity_in_base)
    return share, "" if share == 1.0 else _slower(share, inputs, asked)


def _slower(share: float, inputs: ArmInput, holding: str) -> str:
    """Why the arm moves with a share of its speed, in words."""
    if share == 0.0:
        return f"waits: {inputs.granted_power:.1f} W are granted, and to hold the arm {holding}"
    return f"slower, at {100.0 * share:.0f} % of the speed planned: {inputs.granted_power:.1f} W are granted"


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


def go_on_at_rate(model: ArmModel, state: ArmState, path: JointPath, dt: float) -> ArmState:
    """A period of `dt` [s] on the path, the rate moved towards what is wanted."""
    wanted = 0.0 if state.paused else state.pace
    clock = PathClock(state.path_time, state.rate, state.rate_change, state.rate_fade)
    clock = advance(path, clock, wanted, _limits(model, path), dt)
    reference = JointReference(*sample(path, clock))
    rate = 0.0 if clock.rate < _STILL else 1.0 if clock.rate > 1.0 - _STILL else clock.rate
    state = replace(state, path_time=clock.time, reference=reference, rate=rate)
    state = replace(state, rate_change=clock.change, rate_fade=clock.fade)
    if state.paused and rate == 0.0 and state.status == "moving":
        part = 100.0 * state.path_time / max(path.duration, 1e-9)
        return replace(state, status="paused", reason=f"paused at {part:.0f} % of the way; the task resume goes on")
    return state


def _limits(model: ArmModel, path: JointPath) -> ClockLimits:
    """The arm's limits, or the same share of them for all joints that the motion uses of one of them at most."""
    acceleration, jerk = path.extremes()[3:]
    share = float(np.max(acceleration / model.max_acceleration)) * _ROUNDING
    sharp = float(np.max(jerk / model.max_jerk)) * _ROUNDING
    return ClockLimits(share * model.max_acceleration, sharp * model.max_jerk)
