"""Errors of the start-up. Each is one sentence that says what is wrong and what would be right."""


class BringupError(Exception):
    """Base of every error raised by sojourn_bringup. `exit_status` is what a script ends with."""

    exit_status = 1


class UsageError(BringupError):
    """The command line or the configuration cannot be used; nothing has been started."""

    exit_status = 2
