"""What a replayed role says, as its bag would have it."""

from collections.abc import Iterable

from sojourn_bags.definitions import full_type
from sojourn_bags.messages import Messages
from sojourn_bags.replay_script import HEARTBEATS, ReplayScript
from sojourn_contract.codecs import encode
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message


class OwnAnswers:
    """Takes all that is said in a replay, and keeps the role's own.

    Attributes:
        by_topic: what it said.
    """

    def __init__(self, script: ReplayScript) -> None:
        self._role = script.role
        self._rows = {row.name for row in script.table.outputs_of(script.role, script.participants) if row.logged}
        self.by_topic: dict[str, Messages] = {}

    def take(self, said: Iterable[tuple[Topic, Message]]) -> None:
        """What was said in a period."""
        for row, message in said:
            if row.name in self._rows and (row.name != HEARTBEATS or message.status[0].name == self._role):
                messages = self.by_topic.setdefault(row.name, Messages(row.name, full_type(row.type)))
                messages.log_times.append(message.stamp)
                messages.data.append(encode(row, message))
