"""A word for which nobody waits: it is said once, and the operator goes on when its answer is in the status."""

from sojourn_operator.steps.step import DONE, OperatorStep, View

TO_ANSWER_S = 1.2
"""Statuses come once a second [s]."""


class Word(OperatorStep):
    """Base of the kinds of word."""

    def end(self, view: View) -> tuple[str, str] | None:
        """See OperatorStep."""
        return (DONE, "") if view.is_over(TO_ANSWER_S) else None
