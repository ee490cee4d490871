"""Nodes of one process in lock-step: what one says at a rate, the others hear as it is, with no middleware between.

Goals and heartbeats, which others may send too, go over the middleware. So does all of it to whoever listens in
another process. In real time nothing is cut short: there the middleware is part of what is tried out.
"""

from collections import deque
from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING

from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message

if TYPE_CHECKING:  # a node knows its neighbours
    from sojourn_contract.node import ContractNode


class Neighbours:
    """What they have said and not heard yet, in its order.

    Args:
        nodes: of this process and this run; each is told of its neighbours.
    """

    def __init__(self, nodes: Sequence["ContractNode"]) -> None:
        self._said: deque[tuple[ContractNode, Topic, Message]] = deque()
        self._takers: dict[str, list[ContractNode]] = {}
        self.sent_outside = False
        """Whether something has been sent over the middleware that a neighbour may have to hear before it goes on."""
        roles = {node.role for node in nodes}
        for node in nodes:
            node.endpoints.onlookers.looks = nodes[0].endpoints.onlookers.looks
            for name in node.endpoints.join(self, roles):
                self._takers.setdefault(name, []).append(node)

    def say(self, row: Topic, message: Message) -> None:
        """Keep what a node says until those who take it hear it."""
        takers = self._takers.get(row.name)
        if takers is None:
            self.sent_outside = self.sent_outside or row.is_event or row.publisher == "all"
            return
        for taker in takers:
            self._said.append((taker, row, message))

    def hear(self, until: Callable[[], bool]) -> bool:
        """Let them hear what is said, and what they answer to it, until nobody says more, something has been sent over
        the middleware, or `until` is true. Returns whether something is left to hear.
        """
        self.sent_outside = False
        said = self._said
        while said and not self.sent_outside and not until():
            taker, row, message = said.popleft()
            taker.hear(row, message)
        return bool(said)


def are_near(row: Topic, roles: Collection[str]) -> bool:
    """Whether a row is heard without the middleware where nodes of these roles are neighbours."""
    return not row.is_event and row.publisher in roles
