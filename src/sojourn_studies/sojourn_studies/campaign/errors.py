"""Errors of campaigns."""

from sojourn_config.command_errors import CommandError

GOES_ON = "what is done is kept: with that mended the same command goes on with the rest"


class CampaignError(CommandError):
    """A campaign that cannot go on. What is done so far is kept."""


class SchedulerGoneError(CampaignError):
    """The scheduler does not answer any more."""

    def __init__(self) -> None:
        super().__init__(f"the scheduler is gone; {GOES_ON}")


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
