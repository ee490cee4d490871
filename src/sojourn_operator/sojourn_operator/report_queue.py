"""What a role tells of its goals between two looks: of a fast stack many statuses, whose ends must not be missed."""

from collections import deque
from typing import NamedTuple

from sojourn_contract.values import DiagnosticArray
from sojourn_operator.goal_messages import report_of
from sojourn_operator.steps.step import FINAL_STATES, GoalReport

MOST = 1000


class ToldReport(NamedTuple):
    """A report, and the stamp of the status that told it last [ns]."""

    report: GoalReport
    stamp: int


class ReportQueue:
    """Of one role."""

    def __init__(self) -> None:
        self._waiting: deque[ToldReport] = deque(maxlen=MOST)
        self._last: ToldReport | None = None

    def hear(self, status: DiagnosticArray) -> None:
        """A status that has come. Raises RefusedMessageError for one that is no report."""
        told = ToldReport(report_of(status), status.stamp)
        if self._waiting and self._waiting[-1].report == told.report:
            self._waiting.pop()
        self._waiting.append(told)

    def look(self) -> ToldReport | None:
        """The newest; but a goal that is over first, one a look. None before the first."""
        while self._waiting:
            self._last = self._waiting.popleft()
            if self._last.report.state in FINAL_STATES:
                break
        return self._last
