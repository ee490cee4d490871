"""Errors of campaigns."""

from sojourn_config.command_errors import CommandError


class CampaignError(CommandError):
    """A campaign that cannot go on. What is done so far is kept."""


class WorkerError(CampaignError):
    """A worker that would not compute what the others do.

    Args:
        reason: in words.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason

    def __reduce__(self) -> tuple[type["WorkerError"], tuple[str]]:
        """As it was made: so it comes out of another process."""
        return type(self), (self.reason,)
