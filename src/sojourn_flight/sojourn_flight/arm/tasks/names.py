"""Names of the arm's tasks, for those who only name them; `requests` has what each of ours asks for."""

from typing import TYPE_CHECKING

from sojourn_machine.registry import Registry

if TYPE_CHECKING:
    from sojourn_flight.arm.tasks.requests import TaskRequest

TASKS: "Registry[type[TaskRequest]]" = Registry("sojourn.arm_tasks", "task of the arm")
"""What each task asks for, by its name."""
