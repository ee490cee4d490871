"""Who may command: one page at a time. Whoever commands first has it, others are told, and may take it. A stop is
everybody's.
"""

from dataclasses import dataclass, replace

from sojourn_console.errors import GoalError


@dataclass(frozen=True)
class Control:
    """Of one console.

    Args:
        holder: number of the page that has it, None for nobody.
    """

    holder: int | None = None

    def taken_by(self, page: int) -> "Control":
        """Taken, from whoever has it."""
        return replace(self, holder=page)

    def check(self, page: int) -> None:
        """Raise GoalError where another page has it."""
        if self.holder not in (None, page):
            raise GoalError("control", f"page {self.holder} has it: press “Take control” to command from here")

    def claimed_by(self, page: int) -> "Control":
        """By a page that wants to command. Raises GoalError where another has it."""
        self.check(page)
        return replace(self, holder=page)

    def without(self, page: int) -> "Control":
        """After a page has gone."""
        return replace(self, holder=None) if self.holder == page else self
