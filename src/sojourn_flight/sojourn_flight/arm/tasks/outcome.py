"""What a period has brought for the operator's last goal, be it one of the arm, a task or a jog.

Goals that a task gives to the arm are the task's own: what becomes of them is between the two.
"""

import numpy as np

from sojourn_flight.arm.goal_events import GoalEvent, was
from sojourn_flight.arm.phases import Paused, Pausing
from sojourn_flight.arm.state import ArmOutput
from sojourn_flight.arm.tasks.activity import NoTask, PausedTask, name_of
from sojourn_flight.arm.tasks.task_state import TaskReport, TaskState
from sojourn_machine.evolution import replace

_STILL = 1.0e-9
"""A joint that turns slower rests [rad/s or m/s]."""
_PAUSED = "paused; the task resume goes on"


def report_of(state: TaskState) -> TaskReport | None:
    """How the task, or the jog, stands; None where the last goal was neither, and in a pause."""
    activity = state.activity
    if isinstance(activity, NoTask | PausedTask) or isinstance(state.arm.phase, Pausing | Paused):
        return None
    return TaskReport(name_of(activity), activity.doing)


def with_outcome(
    state: TaskState, output: ArmOutput, answer: GoalEvent | None, is_of_task: bool
) -> tuple[TaskState, ArmOutput]:
    """The state after a period, and the arm's output with the events and the status that the operator is told.

    Args:
        output: of the arm. answer: to a task or a jog that was asked for in this period.
        is_of_task: the arm's goal of this period is one that a task gave.
    """
    if answer is None and not output.events and isinstance(state.activity, NoTask):
        return state, output
    report = report_of(state)
    answers: tuple[GoalEvent, ...] = () if answer is None else (answer,)
    if not is_of_task:
        answers += tuple(event for event in output.events if event.is_answer)
    refusal = answer.reason if answer is not None else ""
    ends: tuple[GoalEvent, ...] = ()
    if isinstance(state.activity, PausedTask):
        rests = float(np.max(np.abs(output.velocities))) < _STILL
        output = replace(output, status="paused" if rests else "moving", reason=refusal or _PAUSED)
        ends = (GoalEvent("paused", output.reason),) if rests else ()
    elif report is None:
        ends = tuple(event for event in output.events if not event.is_answer)
    elif report.doing.state != "moving":
        ends = (GoalEvent(report.doing.state, report.doing.reason),)
    under_way = state.under_way or was("accepted", answers)
    events = answers + ends if under_way else answers
    if under_way != state.under_way or (under_way and ends):
        state = replace(state, under_way=under_way and not ends)
    if refusal or events != output.events:
        output = replace(output, events=events, reason=refusal or output.reason)
    return state, output
