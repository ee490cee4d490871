"""A feed that hears what a test puts into it."""

from deaf_feed import DeafFeed

from sojourn_console.feed import FeedMessage
from sojourn_console.page import SLOW, Page
from sojourn_console.panels.head import HeadPanel
from sojourn_contract.codecs import encode
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import Message


class ToldFeed(DeafFeed):
    """Hears what waits, at the next look.

    Args:
        table: topics of the run.

    Attributes:
        jumped: whether another run has begun, told at the next look.
    """

    def __init__(self, table: TopicTable) -> None:
        super().__init__()
        self._table, self._waiting, self.jumped = table, list[FeedMessage](), False

    def tell(self, name: str, message: Message) -> None:
        """Have a message wait."""
        row = self._table.topic(name)
        self._waiting.append(FeedMessage(row, encode(row, message), message.stamp))

    def poll(self) -> list[FeedMessage]:
        found, self._waiting = self._waiting, []
        return found

    def has_jumped(self) -> bool:
        jumped, self.jumped = self.jumped, False
        return jumped


def show(page: Page) -> None:
    """Look until the panels have been shown."""
    for _ in range(SLOW):
        page.look()


def head_of(page: Page) -> HeadPanel:
    head = page._head[0]
    assert isinstance(head, HeadPanel)
    return head
