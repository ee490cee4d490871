"""A program of an operator beside a running stack: a node that hears and speaks topics, and no role."""

import os
import time
from collections.abc import Callable
from typing import Any, Self

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions

from sojourn_config.ros_environment import ros_variables
from sojourn_contract import qos
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.decoding import hearing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stop_flag import StopFlag
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message


class Desk:
    """A context manager.

    Args:
        name: of its node. domain, namespace: where the stack is.
    """

    def __init__(self, name: str, domain: int, namespace: str) -> None:
        self.name, self.domain, self.namespace = name, domain, namespace
        self.stop = StopFlag()

    def __enter__(self) -> Self:
        os.environ.update(ros_variables(self.domain))
        self.stop.install()
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._node = ClosedNode(self.name, namespace=self.namespace)
        self._executor = EventsExecutor()
        self._executor.add_node(self._node)
        return self

    def __exit__(self, *_error: object) -> None:
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown()

    def listen(
        self,
        row: Topic,
        take: Callable[[Message], None],
        lockstep: bool = True,
        role: str = "",
        quality: QoSProfile | None = None,
    ) -> Any:
        """Give every message of a row that can be read to `take`.

        role: recorder, for whom none may be lost. quality: of a row that has one of its own.
        """
        hear = hearing(row, take, self._pass_over)
        profile = quality or qos.profile(row, lockstep, role)
        return self._node.create_subscription(message_class(row.type), row.name.lstrip("/"), hear, profile, raw=True)

    def sender(self, row: Topic) -> Any:
        """Publisher of a row."""
        kind, name = message_class(row.type), row.name.lstrip("/")
        return self._node.create_publisher(kind, name, qos.profile(row, lockstep=True))

    def spin(self, wall_s: float) -> None:
        """Take what arrives for so long [s]."""
        end = time.monotonic() + wall_s
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    @property
    def node(self) -> Node:
        """For what a desk has no method for."""
        return self._node

    @property
    def place(self) -> str:
        """Where it is, in words."""
        return f"domain {self.domain}" + (f", namespace {self.namespace}" if self.namespace else "")

    def _pass_over(self, refusal: RefusedMessageError) -> None:
        """Of what cannot be read."""
        self._node.get_logger().warning(f"refused: {refusal}", throttle_duration_sec=1.0)
