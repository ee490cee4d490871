"""Listens to a running stack and hands everything that it says to the judge, with the endpoints that it has."""

import os
import time
from collections import deque
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from typing import Any

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from sojourn_config.command_errors import UsageError
from sojourn_config.ros_environment import ros_variables
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.conformance.endpoints import Endpoint
from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.judge import CLOCK, Judge
from sojourn_contract.conformance.take_bytes import take_bytes
from sojourn_contract.stop_flag import StopFlag
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, STANDARD
from sojourn_contract.types import message_class
from sojourn_operator.listeners import UNKNOWN_NODE

FOUND_S = 5.0
"""Wall time within which a stack must be found, and its clock must run."""
SETTLE_S = 0.5
"""Wall time for the rest of the graph to be found once the clock has been."""
SILENT_S = 3.0
"""Wall time without a message after which the run counts as over."""
DEPTH = 4000
"""Messages of a topic that wait here at most: a lock-step run is fast."""
ALL = "all"


class NothingRunsError(UsageError):
    """There is nothing to judge on the domain."""


@dataclass
class LiveStack:
    """What a running stack consists of.

    Attributes:
        lockstep: mode of time. nodes: name of the node that plays each role. endpoints: of every topic of the contract.
        table: the topics of its run.
    """

    lockstep: bool
    nodes: dict[str, str] = field(default_factory=dict)
    endpoints: dict[str, list[tuple[str, Endpoint]]] = field(default_factory=dict)
    table: TopicTable = STANDARD

    def role_of(self, name: str) -> str:
        """Role that a node plays, by its own name or the role's. Raises UsageError with the valid names."""
        for role, node in self.nodes.items():
            if name in (role, node):
                return role
        known = ", ".join(dict.fromkeys([*self.nodes, *self.nodes.values()]))
        raise UsageError(f"--node: no node {name!r} takes part, allowed is one of {known}")

    def judge_endpoints(self, judge: Judge, roles: Collection[str]) -> None:
        """Types and quality of service of these roles' endpoints, and endpoints that they should have."""
        for role in roles:
            node = self.nodes[role]
            for row in self.table.outputs_of(role, self.nodes):
                self._judge_row(judge, row, node, publishes=True)
            for row in self._inputs(role):
                self._judge_row(judge, row, node, publishes=False)
        for row in self.table:
            speakers = [node for node, found in self.endpoints[row.name] if found.publishes]
            if row.publisher in roles and not row.is_event and len(speakers) > 1:
                finding = Finding("publishers", ", ".join(sorted(speakers)), "one")
                judge.report.add("endpoint", row.name, None, [finding])

    def _judge_row(self, judge: Judge, row: Topic, node: str, publishes: bool) -> None:
        found = [end for name, end in self.endpoints[row.name] if name == node and end.publishes == publishes]
        for endpoint in found:
            judge.endpoint(row.name, endpoint)
        if not found:
            what = "publisher" if publishes else "subscription"
            finding = Finding(f"{what} of {node}", "missing", "one for every topic of the role")
            judge.report.add("endpoint", row.name, None, [finding])

    def _inputs(self, role: str) -> Iterator[Topic]:
        for row in self.table.inputs_of(role, self.nodes):
            if row.is_event or row.publisher == ALL or not self.lockstep or row.publisher in self.nodes:
                yield row


class LiveSource:
    """Ears on a domain. A context manager.

    Args:
        domain, namespace: where the stack is. table: the topics of its run.
    """

    def __init__(self, domain: int, namespace: str, table: TopicTable = STANDARD) -> None:
        self.domain, self.namespace, self.table = domain, namespace, table
        self.stop = StopFlag()
        self._waiting: deque[tuple[Topic, bytes]] = deque()
        self._readers: dict[str, Any] = {}

    def __enter__(self) -> "LiveSource":
        os.environ.update(ros_variables(self.domain))
        self.stop.install()
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._node = ClosedNode("contract_check", namespace=self.namespace)
        self._executor = EventsExecutor()
        self._executor.add_node(self._node)
        return self

    def __exit__(self, *_error: object) -> None:
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown()

    def find(self) -> LiveStack:
        """The stack that runs here. Raises NothingRunsError if there is none within FOUND_S."""
        place = f"domain {self.domain}" + (f", namespace {self.namespace}" if self.namespace else "")
        if not self._wait(lambda: bool(self._endpoints(self.table.topic(CLOCK)))):
            raise NothingRunsError(
                f"no stack runs on {place}: nobody publishes /clock (start one with scripts/start.py)"
            )
        # /clock alone until the run goes: a node that waits for its listeners must not count this one among them
        self._listen(self.table.topic(CLOCK))
        if not self._wait(lambda: bool(self._waiting)):
            raise NothingRunsError(f"the stack on {place} does not run: nothing came on /clock within {FOUND_S:g} s")
        self._spin(SETTLE_S)
        self._wait(lambda: all(name != UNKNOWN_NODE for row in self.table for name, _ in self._endpoints(row)))
        endpoints = {row.name: self._endpoints(row) for row in self.table}
        nodes: dict[str, str] = {}
        for role in ROLES:
            for row in self.table:
                speakers = [node for node, found in endpoints[row.name] if found.publishes]
                if row.publisher == role and speakers and not (row.is_event and role not in speakers):
                    nodes.setdefault(role, speakers[0])
        clocks = [found for _, found in endpoints[CLOCK] if found.publishes]
        return LiveStack(any(found.reliability == "reliable" for found in clocks), nodes, endpoints, self.table)

    def listen(self, stack: LiveStack, judge: Judge, seconds: float) -> float:
        """Hand everything that comes within `seconds` of wall time to the judge. Returns how long it listened [s].

        Ends early if the run ends, or on Ctrl-C.
        """
        for row in self.table:
            if row.name not in self._readers:
                self._listen(row, any(end.reliability == "best_effort" for _, end in stack.endpoints[row.name]))
        spoken = [row.name for row in self.table if any(end.publishes for _, end in stack.endpoints[row.name])]
        self._wait(lambda: all(self._readers[name].get_publisher_count() for name in spoken))
        self._spin(SETTLE_S)
        self._waiting.clear()
        begin = heard = time.monotonic()
        while not self.stop.is_set and time.monotonic() - begin < seconds:
            self._spin(0.02)
            if self._waiting:
                heard = time.monotonic()
            elif time.monotonic() - heard > SILENT_S:
                break
            while self._waiting:
                take_bytes(judge, *self._waiting.popleft())
        return time.monotonic() - begin

    def _listen(self, row: Topic, best_effort: bool = False) -> None:
        """Subscribe. What some publisher offers as best effort is asked for as that, or it would not be heard."""
        waiting, name = self._waiting, row.name
        best_effort = best_effort or any(found.reliability == "best_effort" for _, found in self._endpoints(row))
        profile = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=DEPTH,
            reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        )
        self._readers[name] = self._node.create_subscription(
            message_class(row.type), name.lstrip("/"), lambda data: waiting.append((row, data)), profile, raw=True
        )

    def _endpoints(self, row: Topic) -> list[tuple[str, Endpoint]]:
        """Endpoints of others on a topic, with the names of their nodes."""
        name = f"{self.namespace}{row.name}"
        found = [
            *((info, True) for info in self._node.get_publishers_info_by_topic(name)),
            *((info, False) for info in self._node.get_subscriptions_info_by_topic(name)),
        ]
        own = self._node.get_name()
        return [
            (info.node_name, Endpoint.of_graph(info, publishes)) for info, publishes in found if info.node_name != own
        ]

    def _wait(self, is_true: Callable[[], bool]) -> bool:
        """Take what comes until something is true, FOUND_S at most. Returns whether it is."""
        end = time.monotonic() + FOUND_S
        while not is_true():
            if self.stop.is_set:
                raise KeyboardInterrupt
            if time.monotonic() > end:
                return False
            self._spin(0.05)
        return True

    def _spin(self, wall_s: float) -> None:
        end = time.monotonic() + wall_s
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)
