"""Errors of the command lines. Each is one sentence that says what is wrong and what would be right."""


class CommandError(Exception):
    """Base of every error that ends a script. `exit_status` is what it ends with."""

    exit_status = 1


class UsageError(CommandError):
    """The command line or the configuration cannot be used; nothing has been started."""

    exit_status = 2
