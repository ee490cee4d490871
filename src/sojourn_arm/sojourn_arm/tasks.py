"""Tasks as they come over /arm/task, and what the status says of them."""

from typing import TypeAlias

from sojourn_arm.measurements import Measured
from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import DiagnosticArray
from sojourn_flight.arm.footing import FootingLoads
from sojourn_flight.arm.goals import ArmGoal
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, ArmOutput
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_flight.arm.tasks.requests import TaskRequest, parse_task
from sojourn_flight.arm.tasks.task_control import TaskInput, TaskReport
from sojourn_machine.evolution import replace

Request: TypeAlias = ArmGoal | TaskRequest | JogCommand
"""What an operator may ask of the arm."""


def task_of(message: DiagnosticArray) -> TaskRequest:
    """Task of a DiagnosticArray: its one status has the task's name, and its values the numbers.

    Raises:
        GoalRefusedError: no status or several; a name, a key or a number that is not allowed.
    """
    if len(message.status) != 1:
        raise GoalRefusedError(f"{len(message.status)} statuses: allowed is one, named {', '.join(TASKS.names())}")
    return parse_task(message.status[0].name, status_values(message))


def task_input(arm: ArmInput, request: Request | None, measured: Measured, loads: FootingLoads | None) -> TaskInput:
    """What the laws take in, with what is asked for in its place: a goal, a task or a jog."""
    task = request if isinstance(request, TaskRequest) else None
    jog = request if isinstance(request, JogCommand) else None
    goal = None if isinstance(request, TaskRequest | JogCommand) else request
    return TaskInput(
        arm=replace(arm, goal=goal),
        task=task,
        jog=jog,
        wrench=measured.wrench,
        efforts=measured.efforts,
        tool=measured.tool,
        loads=loads,
    )


def progress_fields(output: ArmOutput, report: TaskReport | None) -> dict[str, str]:
    """Fields of /arm/status that say how far the arm is: with a goal on its way there; with a task as it tells itself,
    or on the way of the arm for it; none while nothing can be told of a task, as before it has begun.
    """
    doing = output if report is None else report.doing
    if report is not None and report.doing.velocity is None and report.doing.progress == 0.0:
        if output.time_to_go == 0.0:
            return {}
        doing = output
    return {"progress": f"{doing.progress:.3f}", "time_to_go": f"{doing.time_to_go:.2f}"}


def task_fields(report: TaskReport | None) -> dict[str, str]:
    """Fields of /arm/status that a task adds; none where the last goal was no task."""
    if report is None:
        return {}
    return {"task": report.name} | {name: f"{value:.6g}" for name, value in report.doing.figures.items()}
