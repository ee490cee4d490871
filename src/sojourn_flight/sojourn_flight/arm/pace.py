"""How fast a motion is run: as planned, slower where less power is granted, or not at all in a pause.

The motion keeps to its path (path_clock.py), and to the accelerations and jerks that it was planned with: one that was
planned slower, because torque or power would not have been enough, is not paused with more of them. A pause at any
moment comes to rest on the checked path, and resuming goes on with what was planned.

Of a guided motion, the velocity that a task wants is made smaller at every period: gravity, friction and the contact
are counted, the inertia of its slow changes is not.
"""

from typing import TypeVar

import numpy as np

from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.motion_load import rate_within, share_within
from sojourn_flight.arm.param_groups import ArmDriveParams
from sojourn_flight.arm.path_clock import ClockLimits, advance, sample
from sojourn_flight.arm.phases import Moving, Paused, Pausing
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, ArmState, Granted
from sojourn_flight.arm.tasks.tip_motion import TipMotion, rates_of
from sojourn_flight.arm.trajectory import JointReference
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

_STILL = 1.0e-9
"""A rate that counts as none [-]."""
_ROUNDING = 1.0 + 1.0e-6

Drives = TypeVar("Drives", bound=ArmDriveParams)


def with_granted_power(params: Drives, granted: Granted) -> Drives:
    """The parameters with the smaller of the arm's own limits and what is granted: power, and torque by the current."""
    update: dict[str, float | tuple[float, ...]] = {}
    if granted.power is not None and (params.power_limit is None or params.power_limit > granted.power):
        update["power_limit"] = granted.power
    if granted.current < 1.0 and params.motor_effort:
        update["motor_effort"] = tuple(granted.current * effort for effort in params.motor_effort)
    return params.model_copy(update=update) if update else params


def follow_granted_power(params: ArmDriveParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    """Set the pace of the motion under way to what is granted from now on."""
    state, moving = replace(state, granted=inputs.granted), state.phase
    if not isinstance(moving, Moving):
        return state
    pace, holding = 1.0, ""
    if inputs.granted.power is not None:
        allowed = with_granted_power(params, inputs.granted)
        pace, peak = rate_within(allowed, model, moving.plan.path, moving.clock.time, inputs.gravity_in_base)
        holding = peak.text
    reason = "" if moving.pace < 1.0 else state.reason
    if pace < 1.0:
        reason = _slower(pace, inputs, holding)
    return replace(state, phase=replace(moving, pace=pace), reason=reason)


def granted_velocity(
    params: ArmDriveParams, model: ArmModel, inputs: ArmInput, motion: TipMotion, wanted: FloatArray, force: FloatArray
) -> tuple[float, str]:
    """The share of a wanted velocity of the tip that what is granted allows, and why it is less than 1, in words.

    Args:
        wanted: (3,) [m/s]. force: of the ground on the tool in base_link (3,) [N].
    """
    if inputs.granted.power is None:
        return 1.0, ""
    positions = motion.joints.position
    contact = -forward_kinematics(model, positions).jacobian[:3].T @ force
    allowed, rates = with_granted_power(params, inputs.granted), rates_of(model, motion, wanted)
    share, asked = share_within(allowed, model, positions, rates, contact, inputs.gravity_in_base)
    return share, "" if share == 1.0 else _slower(share, inputs, asked)


def _slower(share: float, inputs: ArmInput, holding: str) -> str:
    """Why the arm moves with a share of its speed, in words."""
    if share == 0.0:
        return f"waits: {inputs.granted.power:.1f} W are granted, and to hold the arm {holding}"
    return f"slower, at {100.0 * share:.0f} % of the speed planned: {inputs.granted.power:.1f} W are granted"


def pause(state: ArmState) -> ArmState:
    """Begin to come to rest on the path.

    Raises:
        GoalRefusedError: no motion under way, or one that is stopping or paused already.
    """
    moving = state.phase
    if not isinstance(moving, Moving):
        raise GoalRefusedError("pause: no motion is under way")
    if isinstance(moving, Pausing | Paused):
        raise GoalRefusedError("pause: the motion is paused already")
    return replace(state, phase=Pausing(moving.plan, moving.clock, moving.pace), reason="comes to rest on its path")


def resume(state: ArmState) -> ArmState:
    """Go on.

    Raises:
        GoalRefusedError: no motion is paused.
    """
    paused = state.phase
    if not isinstance(paused, Pausing | Paused):
        raise GoalRefusedError("resume: no motion is paused")
    return replace(state, phase=Moving(paused.plan, paused.clock, paused.pace), reason="")


def runs_as_planned(moving: Moving) -> bool:
    """Whether the motion goes on at the rate that it was planned with."""
    return moving.clock.rate == 1.0 and moving.pace == 1.0 and not isinstance(moving, Pausing | Paused)


def go_on_at_rate(model: ArmModel, state: ArmState, moving: Moving, dt: float) -> tuple[ArmState, Moving]:
    """A period of `dt` [s] on the path, the rate moved towards what is wanted: the state, and its phase."""
    path, pausing = moving.plan.path, isinstance(moving, Pausing | Paused)
    clock = advance(path, moving.clock, 0.0 if pausing else moving.pace, _limits(model, path), dt)
    reference = JointReference(*sample(path, clock))
    rate = 0.0 if clock.rate < _STILL else 1.0 if clock.rate > 1.0 - _STILL else clock.rate
    moving, reason = replace(moving, clock=replace(clock, rate=rate)), state.reason
    if isinstance(moving, Pausing) and rate == 0.0:
        part = 100.0 * clock.time / max(path.duration, 1e-9)
        moving = Paused(moving.plan, moving.clock, moving.pace)
        reason = f"paused at {part:.0f} % of the way; the task resume goes on"
    return replace(state, phase=moving, reference=reference, reason=reason), moving


def _limits(model: ArmModel, path: JointPath) -> ClockLimits:
    """The arm's limits, or the same share of them for all joints that the motion uses of one of them at most.

    A motion that stands for all of its time uses nothing of them: its clock may change as the arm itself may.
    """
    acceleration, jerk = path.extremes()[3:]
    share = float(np.max(acceleration / model.max_acceleration)) * _ROUNDING
    sharp = float(np.max(jerk / model.max_jerk)) * _ROUNDING
    return ClockLimits((share or 1.0) * model.max_acceleration, (sharp or 1.0) * model.max_jerk)
