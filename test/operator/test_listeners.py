"""Who hears a publisher, by the graph of a real domain."""

import time
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, QoSProfile

from domains import own_domain
from sojourn_contract import qos
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_operator.listeners import Listeners

PATIENCE_S = 60.0
ROW = topic("/cmd_vel")
KIND = message_class(ROW.type)


class Graph:
    """Nodes on a domain, and a publisher of velocities."""

    def __init__(self, domain: int) -> None:
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = self.named("console")
        self.sender = self.node.create_publisher(KIND, "cmd_vel", qos.profile(ROW, lockstep=True))
        self._kept: list[Any] = []

    def named(self, name: str) -> Any:
        return rclpy.create_node(name, context=self.context, enable_rosout=False)

    def hears(self, name: str, profile: Any) -> Listeners:
        """What is known once the graph knows of one more that wants it."""
        node = self.named(name)
        self._kept += [node, node.create_subscription(KIND, "cmd_vel", lambda _: None, profile)]
        count, end = len(self._kept) // 2, time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            found = self.node.get_subscriptions_info_by_topic("cmd_vel")
            if len(found) == count and (Listeners(self.node, self.sender).are_all_there or name != "sojourn_drive"):
                break
            time.sleep(0.02)
        return Listeners(self.node, self.sender)


def test_who_can_never_hear_it_is_not_waited_for() -> None:
    """A terminal that asked for what was said before it came: no stop was sent to the drive beside it."""
    with own_domain() as domain:
        graph = Graph(domain)
        try:
            assert not Listeners(graph.node, graph.sender).somebody_acts
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            assert not graph.hears("terminal", latched).somebody_acts
            found = graph.hears("sojourn_drive", qos.profile(ROW, lockstep=True))
            assert found.somebody_acts and found.are_all_there
        finally:
            rclpy.shutdown(context=graph.context)


def test_the_recorder_does_not_act() -> None:
    with own_domain() as domain:
        graph = Graph(domain)
        try:
            assert not graph.hears("recorder", qos.profile(ROW, lockstep=True)).somebody_acts
        finally:
            rclpy.shutdown(context=graph.context)
