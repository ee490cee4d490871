"""Who looks at a run and does not listen to it: the console's page, which shows thirty pictures a second.

In lock-step a run goes many times as fast as its clock. To send each message to somebody who looks at one in a dozen
costs the loop more than all that the page does, so a topic that onlookers alone hear is said as often as they look, by
the wall clock. An onlooker is a console's reader with best effort; what it wants in full it hears reliably.
"""

import time
from collections.abc import Mapping
from typing import Any

from sojourn_contract.link_topics import BY_HAND

LOOK_S = 0.03
"""Wall time between two messages of a topic that onlookers alone hear [s]."""
ASK_S = 0.5
"""Wall time between two questions of who hears a topic [s]: to ask takes a tenth of a millisecond."""


class Onlookers:
    """Of the topics of a node.

    Args:
        node: of the ROS library. senders: its publishers of what may rest, by topic.
    """

    def __init__(self, node: Any, senders: Mapping[str, Any]) -> None:
        self._node, self._senders = node, senders
        self._said: dict[str, float] = {}
        """When a topic that onlookers alone hear was said last [s of the wall clock]."""
        self._asked = 0.0
        self._counts: Mapping[str, int] = {}

    def look(self, counts: Mapping[str, int]) -> None:
        """See who is there. counts: how many hear each topic."""
        now = time.monotonic()
        if counts == self._counts and now < self._asked + ASK_S:
            return
        self._asked, self._counts = now, counts
        alone = [name for name in self._senders if counts[name] and self._are_alone(name)]
        self._said = {name: self._said.get(name, 0.0) for name in alone}

    def rests(self, topic: str) -> bool:
        """Whether a message of a topic may be left out: nobody but onlookers hears it, and they have just had one."""
        said = self._said.get(topic)
        if said is None:
            return False
        now = time.monotonic()
        if now < said + LOOK_S:
            return True
        self._said[topic] = now
        return False

    def _are_alone(self, topic: str) -> bool:
        listeners = self._node.get_subscriptions_info_by_topic(self._senders[topic].topic_name)
        return bool(listeners) and all(map(_is_onlooker, listeners))


def _is_onlooker(listener: Any) -> bool:
    from rclpy.qos import ReliabilityPolicy

    is_best_effort = listener.qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT
    return is_best_effort and listener.node_name == BY_HAND
