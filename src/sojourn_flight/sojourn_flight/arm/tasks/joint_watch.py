"""Joints that stay behind while a task or a jog guides the tip: held by something, or dead (dead_joints.py)."""

import numpy as np

from sojourn_flight.arm import controller
from sojourn_flight.arm.contact_guard import Before, Felt, touched
from sojourn_flight.arm.dead_joints import stands_still
from sojourn_flight.arm.deflection import joint_positions
from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import FollowingParams
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.tasks.activity import name_of
from sojourn_flight.arm.tasks.ended import given_up
from sojourn_flight.arm.tasks.task_state import TaskInput, TaskState
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray


def feel(model: ArmModel, state: TaskState, inputs: TaskInput, tip: TipPose) -> Felt:
    """What acts on the arm from outside; `tip`: as measured."""
    force = None
    if inputs.wrench is not None:
        force = state.sense.contact(model, tip, inputs.wrench, inputs.arm.gravity_in_base)
    return Felt(force, state.observer.residual)


def held_back(params: FollowingParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> str:
    """Which joint is too far from its reference, in words; empty where none is."""
    if not state.arm.started:
        return ""
    behind = _behind(state, inputs)
    worst = int(np.argmax(behind))
    if behind[worst] <= params.following_error_limit:
        return ""
    off = f"{behind[worst]:.3f} {model.unit(worst)}"
    return f"{model.joint_names[worst]} is {off} from its reference: something holds it"


def without_dead(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> TaskState:
    """A guided motion or a jog is given up where one joint does not move and nothing touches the arm.

    While the tool presses on something, what holds a joint may be that; a motion that touches nothing will tell.
    """
    if inputs.efforts is None or not inputs.arm.allowed or not state.arm.started:
        return state
    behind = _behind(state, inputs)
    if behind.max() <= params.following_error_limit or not stands_still(params, model, behind, inputs.arm.velocities):
        return state
    tip = forward_kinematics(model, inputs.arm.positions)
    if touched(params.contact, model, tip, Before(0.0, np.zeros(model.joint_count)), feel(model, state, inputs, tip)):
        return state
    positions = joint_positions(params, model, inputs.arm.positions, inputs.arm.gravity_in_base)
    arm, _ = controller.give_way(params, model, state.arm, replace(inputs.arm, positions=positions, feels=True), behind)
    return replace(state, arm=arm, activity=given_up(name_of(state.activity), arm.reason))


def _behind(state: TaskState, inputs: TaskInput) -> FloatArray:
    """Sizes of the following errors (n,) [rad or m]."""
    return np.asarray(np.abs(state.arm.reference.position + state.arm.trim - inputs.arm.positions))
