"""A running stack heard over its topics, and spoken to over those of the operator.

The console is one more listener: no role waits for it, and what it does not look at it does not hear. It hears /clock
alone until the run goes, because nodes that wait for their listeners must not count this one among them. What it wants
in full it hears reliably, all else with best effort. A run in lock-step tells it both as often as it looks, see
`sojourn_contract.onlookers`.

All of the ROS library is used by one thread, which others ask by a queue.
"""

import os
import queue
import threading
from collections import deque
from collections.abc import Callable, Collection
from functools import partial
from time import monotonic
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from sojourn_bringup.instance import RoleInUseError, RoleTokens
from sojourn_config.ros_environment import ros_variables
from sojourn_console.errors import GoalError
from sojourn_console.feed import FeedMessage
from sojourn_contract import onlookers, qos
from sojourn_contract.bundling import unpack
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.codecs import encode
from sojourn_contract.decoding import stamp_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.link_topics import BY_HAND, EARTH, OPERATOR
from sojourn_contract.prompt_executor import PromptExecutor
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import ROLES, Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message
from sojourn_operator.listeners import Listeners

CLOCK = "/clock"
ROLE = BY_HAND
MOST_WAITING = 20_000
"""Messages of a topic that is wanted in full, at most, until they are fetched."""
SILENT_S = 5.0
"""Wall time without a word after which a run counts as silent."""
CLAIM_S = 1.0
"""Wall time from one attempt to have the control to the next."""
_SPIN_S = 0.02
_MATCH_S = 2.0
"""Wall time within which whoever acts on a goal must have been found."""


class LiveFeed:
    """Ears and mouth on a domain. It begins to listen at once.

    Args:
        domain, namespace: where the stack is. table: the topics of its run.
    """

    def __init__(self, domain: int, namespace: str, table: TopicTable) -> None:
        self.now = 0
        self._table, self._namespace = table, namespace
        self._waiting: dict[str, deque[bytes]] = {}
        self._readers: dict[str, Any] = {}
        self._looks: list[Any] = []
        """Readers of what nodes tell onlookers."""
        self._senders: dict[str, Any] = {}
        self._tasks: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._looked_at: frozenset[str] = frozenset()
        self._in_full: frozenset[str] = frozenset()
        self._is_on = True
        self._heard_at = monotonic()
        self._jumped = False
        self._token = RoleTokens(domain, namespace, (ROLE,))
        self._refusal, self._claimed_at = self._claimed(), monotonic()
        os.environ.update(ros_variables(domain))
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._node = ClosedNode(ROLE, namespace=namespace)
        self._executor = PromptExecutor()
        self._executor.add_node(self._node)
        self._listen(table.topic(CLOCK), in_full=False)
        self._thread = threading.Thread(target=self._run, name="topics", daemon=True)
        self._thread.start()

    @property
    def is_heard(self) -> bool:
        """Whether the run goes: its clock has been heard."""
        return self.now > 0

    def poll(self) -> list[FeedMessage]:
        found: list[FeedMessage] = []
        for name, waiting in list(self._waiting.items()):
            row = self._table.topic(name)
            while waiting:
                data = waiting.popleft()
                try:
                    found.append(FeedMessage(row, data, stamp_of(name, data)))
                except RefusedMessageError:
                    found.append(FeedMessage(row, data, self.now))  # who reads it counts it
        found.sort(key=lambda heard: heard.time)
        clocks = [heard.time for heard in found if heard.row.name == CLOCK]
        if clocks:  # stamps of what has come over a link to Earth are of long ago
            newest = clocks[-1]
            self._jumped = self._jumped or newest < self.now - 1_000_000_000  # another run has begun on the domain
            self.now = newest if self._jumped else max(self.now, newest)
        return [heard for heard in found if heard.row.name != CLOCK]

    def want(self, looked_at: Collection[str], in_full: Collection[str]) -> None:
        wanted, full = frozenset((*looked_at, *in_full)), frozenset(in_full)
        if (wanted, full) != (self._looked_at, self._in_full):
            self._looked_at, self._in_full = wanted, full
            self._tasks.put(self._listen_as_wanted)

    def has_jumped(self) -> bool:
        jumped, self._jumped = self._jumped, False
        return jumped

    def silence(self) -> str:
        quiet = monotonic() - self._heard_at
        if not self.is_heard or quiet < SILENT_S:
            return ""
        return f"nothing is heard of the run for {quiet:.0f} s: what is shown is of {self.now * 1e-9:.1f} s"

    def refusal(self) -> str:
        if self._refusal and monotonic() > self._claimed_at + CLAIM_S:  # whoever had it may have gone
            self._refusal, self._claimed_at = self._claimed(), monotonic()
        if self._refusal:
            return self._refusal
        return "" if self.is_heard else "no run is heard yet"

    def send(self, name: str, message: Message) -> None:
        row = self._table.topic(name)
        if not row.is_event or row.publisher not in (OPERATOR, BY_HAND):
            raise GoalError(name, "allowed is a topic on which operators speak")
        data, done = encode(row, message), threading.Event()
        if self.refusal() and not (self.is_heard and _is_stop(name, message)):
            raise GoalError(name, self.refusal())
        problems: list[str] = []
        self._tasks.put(lambda: self._publish(row, data, problems, done))
        if not done.wait(_MATCH_S + 1.0):
            raise GoalError(name, "it could not be sent in time")
        if problems:
            raise GoalError(name, problems[0])

    def close(self) -> None:
        self._is_on = False
        self._thread.join(timeout=5.0)
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown()
        self._token.__exit__(None, None, None)

    def _claimed(self) -> str:
        """Take the control of the domain; who has it, in words, where that cannot be."""
        try:
            self._token.__enter__()
        except RoleInUseError as error:
            who = f"process {error.holder}" if error.holder else "another process"
            return f"{who} is a console with the control here: this one looks on, and can stop"
        return ""

    def _run(self) -> None:
        while self._is_on:
            while not self._tasks.empty():
                self._tasks.get()()
            if self._looked_at and self.is_heard and len(self._readers) == 1:
                self._listen_as_wanted()
            self._executor.spin_once(timeout_sec=_SPIN_S)

    def _listen_as_wanted(self) -> None:
        if not self.is_heard:
            return
        if not self._looks:
            self._looks = [self._looking_at(role) for role in {row.publisher for row in self._table} & set(ROLES)]
        for name in set(self._readers) - {CLOCK}:
            if name not in self._looked_at or (name in self._in_full) != (self._waiting[name].maxlen == MOST_WAITING):
                self._node.destroy_subscription(self._readers.pop(name))
        for name in self._waiting.keys() - self._looked_at - {CLOCK}:
            del self._waiting[name]
        for name in self._looked_at - self._readers.keys():
            row = self._table.get(name)
            if row is not None:
                self._listen(row, name in self._in_full)

    def _listen(self, row: Topic, in_full: bool) -> None:
        self._waiting[row.name] = deque(self._waiting.get(row.name, ()), MOST_WAITING if in_full else 1)
        hear, name = partial(self._hear, row.name), row.name
        profile = qos.profile(row, lockstep=True) if in_full else qos.looking()
        kind = message_class(row.type)
        self._readers[name] = self._node.create_subscription(kind, name.lstrip("/"), hear, profile, raw=True)

    def _looking_at(self, role: str) -> Any:
        """A reader of what a role tells onlookers."""
        row = onlookers.looks_of(role)

        def hear(data: bytes) -> None:
            try:
                said = unpack(row.name, data)
            except RefusedMessageError:  # somebody else's
                return
            for name, content in said:
                self._hear(name, content)

        name, kind = row.name.lstrip("/"), message_class(row.type)
        return self._node.create_subscription(kind, name, hear, onlookers.quality(row), raw=True)

    def _hear(self, name: str, data: bytes) -> None:
        if name in self._waiting:
            self._waiting[name].append(data)
        if name == CLOCK:
            self._heard_at = monotonic()
            if not self.now:
                self.now = 1

    def _publish(self, row: Topic, data: bytes, problems: list[str], done: threading.Event) -> None:
        """On the topic, once whoever acts on it has been found."""
        if row.name not in self._senders:
            profile = qos.profile(row, lockstep=True)
            self._senders[row.name] = self._node.create_publisher(
                message_class(row.type), row.name.lstrip("/"), profile
            )
        sender, end = self._senders[row.name], monotonic() + _MATCH_S
        heard = Listeners(self._node, sender, (ROLE,))
        while not heard.are_all_there and monotonic() < end:
            self._executor.spin_once(timeout_sec=_SPIN_S)
            heard = Listeners(self._node, sender, (ROLE,))
        if heard.somebody_acts:  # who else wants it is not waited for any longer
            sender.publish(data)
        else:
            problems.append(f"nobody acts on it: is the role {' or '.join(row.subscribers)} there?")
        done.set()


def _is_stop(name: str, message: Message) -> bool:
    """Whether it is everybody's: a stop of drive or arm, over a link to Earth or not."""
    own = name.removeprefix(EARTH)
    return own == "/arm/stop" or (own == "/cmd_vel" and not message.linear.any() and not message.angular.any())
