"""An executor of events that does not fall behind for good.

The ROS library's has an event for each message that has come, in a queue without limit, also for one that its topic's
history has dropped since. Who gets more than it can take answers later and later and grows in memory, for as long as
that lasts. Here the queue is thrown away where an event waits in it for too long; what the histories hold is taken
then, and no message is lost that was not lost before.
"""

import time
from typing import Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node

MOST_DELAY_S = 0.5
"""Wall time for which an event may wait [s]."""


class PromptExecutor:
    """Of nodes with readers and timers, whose callbacks take the message alone.

    Args:
        context: of the ROS library; None for the default one. most_delay_s: see MOST_DELAY_S.
    """

    def __init__(self, context: Context | None = None, most_delay_s: float = MOST_DELAY_S) -> None:
        self._context, self._most_delay = context, most_delay_s
        self._nodes: list[Node] = []
        self._events = EventsExecutor(context=context)
        self._probed_at = time.monotonic()
        self._probe: Any = None
        """An event of its own in the queue, by which it sees how long others wait."""

    def add_node(self, node: Node) -> None:
        """From now on."""
        self._nodes.append(node)
        self._events.add_node(node)

    def remove_node(self, node: Node) -> None:
        """No longer; nothing for one that it does not have."""
        self._nodes = [one for one in self._nodes if one is not node]
        self._events.remove_node(node)

    def spin_once(self, timeout_sec: float) -> None:
        """Let the next event take effect, or wait for it so long [s]."""
        self._events.spin_once(timeout_sec=timeout_sec)
        if time.monotonic() - self._probed_at < self._most_delay:
            return
        if self._probe is not None and not self._probe.done():
            self._begin_anew()
        self._probed_at = time.monotonic()
        # of nothing else: a queue that is thrown away never lets it go, nor what it has
        self._probe = self._events.create_task(_nothing)

    def shutdown(self) -> None:
        """Let all nodes go."""
        self._nodes = []
        self._events.shutdown()

    def _begin_anew(self) -> None:
        """Throw the queue away and take what the histories hold, of which the new one is not told, as it came."""
        self._events.shutdown()
        self._events = EventsExecutor(context=self._context)
        for node in self._nodes:
            self._events.add_node(node)
        self._events.spin_once(timeout_sec=0.0)  # from here on it is told
        taken = [one for node in self._nodes for reader in node.subscriptions for one in _taken(reader)]
        for _, callback, message in sorted(taken, key=lambda one: one[0]):
            callback(message)


def _nothing() -> None:
    """Of a probe."""


def _taken(reader: Any) -> list[tuple[int, Any, Any]]:
    """What its history holds: when each message was received [ns], who takes it, and the message. What comes meanwhile
    has its event.
    """
    found = []
    for _ in range(reader.qos_profile.depth):
        with reader.handle:
            one = reader.handle.take_message(reader.msg_type, reader.raw)
        if one is None:
            break
        found.append((one[1]["received_timestamp"], reader.callback, one[0]))
    return found
