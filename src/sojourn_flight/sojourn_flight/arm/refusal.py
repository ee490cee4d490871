"""The refusal of a goal, apart from the goals: an operator's side reads it without what an arm needs."""

from sojourn_machine.errors import MachineError


class GoalRefusedError(MachineError):
    """A goal that is not carried out; the message is the reason, with numbers."""
