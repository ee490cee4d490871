"""A feed that hears nothing, and remembers what is said."""

from collections.abc import Collection

from sojourn_console.errors import GoalError
from sojourn_console.feed import FeedMessage
from sojourn_contract.values import Message


class DeafFeed:
    """Hears nothing, and remembers what is said."""

    def __init__(self) -> None:
        self.now = 5_000_000_000
        self.said: list[tuple[str, Message]] = []
        self.deaf: set[str] = set()

    def poll(self) -> list[FeedMessage]:
        return []

    def want(self, looked_at: Collection[str], in_full: Collection[str]) -> None:
        return

    def has_jumped(self) -> bool:
        return False

    def silence(self) -> str:
        return ""

    def refusal(self) -> str:
        return ""

    def send(self, name: str, message: Message) -> None:
        if name in self.deaf:
            raise GoalError(name, "nobody acts on it")
        self.said.append((name, message))

    def machine_stamp(self, name: str, stamp: int) -> str:
        return str(stamp)

    def close(self) -> None:
        return
