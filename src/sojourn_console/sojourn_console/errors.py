"""Errors of the console: each says what is wrong and what to do."""

from sojourn_config.command_errors import CommandError


class ConsoleError(CommandError):
    """Base of every error raised by sojourn_console."""


class UnguardedServerError(ConsoleError):
    """The page's server would let in who has no token: it is not started."""

    def __init__(self) -> None:
        super().__init__(
            "the page's server asks nobody for its token with this version of viser or websockets: it is not started "
            "(requirements.lock has the versions that do)"
        )


class NoWorldError(ConsoleError):
    """It is not known which scenario the stack runs.

    Args:
        reason: what was looked for.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(f"it is not known which scenario the stack runs: {reason}; name it: scripts/console SCENARIO")


class GoalError(ConsoleError):
    """A goal that cannot be sent.

    Args:
        what: of it. reason: why, and what is allowed.
    """

    def __init__(self, what: str, reason: str) -> None:
        super().__init__(f"{what}: {reason}")
        self.what, self.reason = what, reason


class LayoutError(ConsoleError):
    """A layout of plots that cannot be read or kept.

    Args:
        name: of it. reason: why, and what is allowed.
    """

    def __init__(self, name: str, reason: str) -> None:
        super().__init__(f"layout {name!r}: {reason}")
        self.name, self.reason = name, reason


class AlarmError(ConsoleError):
    """An alarm that cannot be acknowledged.

    Args:
        what: was asked. reason: why not, and what is allowed.
    """

    def __init__(self, what: str, reason: str) -> None:
        super().__init__(f"{what}: {reason}")
        self.what, self.reason = what, reason


class SequenceError(ConsoleError):
    """A sequence that cannot be carried out.

    Args:
        reason: everything that is wrong with it, a line each.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
