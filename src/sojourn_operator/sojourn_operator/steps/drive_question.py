"""Ask what it would take to drive through points; nothing moves."""

from typing import ClassVar

from sojourn_contract.values import Message
from sojourn_operator.goal_messages import question_message
from sojourn_operator.steps.drive_route import DriveRouteStep
from sojourn_operator.steps.step import View
from sojourn_operator.steps.word import Word


class DriveQuestionStep(Word, DriveRouteStep):
    """Points of which the drive says what a way through them would take: /drive/question."""

    topic: ClassVar[str] = "/drive/question"

    def describe(self) -> str:
        """See OperatorStep."""
        return f"ask about {len(self.points)} points"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return question_message(super().goal(view))
