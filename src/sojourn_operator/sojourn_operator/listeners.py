"""Who hears what an operator sends, as far as the node that sends it has been told."""

from collections.abc import Collection
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

RECORDER = "recorder"
"""Hears everything, and acts on nothing."""
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
"""Name that ROS gives to a node of which it knows an endpoint only, so far."""


class Listeners:
    """Of one topic of a publisher, at one moment.

    Whoever wants the topic with another type, or asks for more than the publisher gives (a terminal that wants what was
    said before it came, Nav2 with another message of that name) is in the graph and never hears anything: nobody waits
    for it.

    Args:
        node: that sends. sender: its publisher. onlookers: names of nodes that do not act, besides the recorder.
    """

    def __init__(self, node: Node, sender: Any, onlookers: Collection[str] = ()) -> None:
        kind = sender.msg_type
        name = f"{kind.__module__.split('.')[0]}/msg/{kind.__name__}"
        self._able = [
            one.node_name
            for one in node.get_subscriptions_info_by_topic(sender.topic_name)
            if one.topic_type == name and _fits(sender, one)
        ]
        self._matched = sender.get_subscription_count()
        self._passive = {RECORDER, UNKNOWN_NODE, *onlookers}

    @property
    def somebody_acts(self) -> bool:
        """Whether somebody who acts on it hears it now, as far as can be told of matches without names."""
        return self._matched > 0 and any(name not in self._passive for name in self._able)

    @property
    def are_all_there(self) -> bool:
        """Whether somebody acts on it, and all who can hear it do."""
        return self.somebody_acts and self._matched >= len(self._able)


def _fits(sender: Any, listener: Any) -> bool:
    """By reliability and durability alone: an endless deadline is another number in the graph than in a profile."""
    wanted = listener.qos_profile
    asked = QoSProfile(depth=1, reliability=wanted.reliability, durability=wanted.durability)
    compatibility, _ = qos_check_compatible(sender.qos_profile, asked)
    return bool(compatibility != QoSCompatibility.ERROR)
