"""Runs nodes of the contract in this process: one as its own process, or several composed on one executor.

Signals are ours, not rclpy's: SIGINT and SIGTERM end the loop between two events, the nodes say farewell,
and only then the context is shut down. The executor's own `spin()` is not used: in this build it hangs at
the end and ignores SIGTERM.
"""

import faulthandler
import sys
import time
from collections.abc import Callable, Iterable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions

from sojourn_config.collector import settle_collector
from sojourn_contract.neighbours import Neighbours
from sojourn_contract.node import ContractNode
from sojourn_contract.prompt_executor import PromptExecutor
from sojourn_contract.stop_flag import StopFlag

TEARDOWN_S = 4.5
"""Wall time after which a process whose middleware does not end is ended all the same, with a trace in its log."""
SETTLE_S = 0.3
"""Wall time without any node acting after which a period counts as answered."""
POLL_S = 0.02
"""Wall time between two looks at the nodes' wall-clock chores."""


def spin(
    nodes: Iterable[ContractNode],
    stop: StopFlag,
    each_poll: Callable[[], bool] = lambda: False,
    when_closed: Callable[[], None] = lambda: None,
    neighbours: Neighbours | None = None,
) -> int:
    """Run nodes until a signal, until all that can finish have, or until `each_poll` returns True.

    Args:
        nodes: the nodes. stop: set by a signal. each_poll: called some times a second.
        when_closed: called once all have said farewell, before the executor lets them go.
        neighbours: what they say to each other without the middleware; None where all goes over it.

    Returns the largest exit status of the nodes. In a composed run the nodes are closed in the given order,
    so the recorder goes last.
    """
    nodes = list(nodes)
    executor = PromptExecutor()
    for node in nodes:
        executor.add_node(node)
    settle_collector()
    next_poll = 0.0

    def turn() -> None:
        _turn(executor, nodes, neighbours)

    try:
        while not stop.is_set:
            turn()
            now = time.monotonic()
            if now >= next_poll:
                next_poll = now + POLL_S
                for node in nodes:
                    node.poll()
                if not rclpy.ok() or each_poll() or any(node.finished for node in nodes if node.ends_the_run):
                    break
        drain(turn, nodes, interrupted=stop.is_set)
        when_closed()
        for node in nodes:
            executor.remove_node(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    return max(node.exit_status for node in nodes)


def _turn(executor: PromptExecutor, nodes: list[ContractNode], neighbours: Neighbours | None) -> None:
    """Let the nodes hear each other for a while, and then what the middleware brings."""
    until = time.monotonic() + POLL_S
    if neighbours is None or not neighbours.hear(lambda: time.monotonic() >= until):
        executor.spin_once(timeout_sec=POLL_S)
        return
    received = -1
    while received != (received := sum(node.received for node in nodes)):  # one message at a time
        executor.spin_once(timeout_sec=0.0)


def drain(turn: Callable[[], None], nodes: list[ContractNode], interrupted: bool = False) -> None:
    """Close the nodes in order, each after what is still on its way to it has been taken.

    Where a signal has ended the run in the middle of a period, those after the plant answer it first: else the record
    would lack what they owe.
    """
    for number, node in enumerate(nodes):
        while not node.is_drained():
            turn()
        node.close()
        if interrupted and node.ends_the_run:
            _settle(turn, nodes[number + 1 :])


def _settle(turn: Callable[[], None], nodes: list[ContractNode]) -> None:
    """Run until none of the nodes has acted for a while."""
    acted, since = [node.now for node in nodes], time.monotonic()
    while nodes and time.monotonic() - since < SETTLE_S:
        turn()
        if acted != (acted := [node.now for node in nodes]):
            since = time.monotonic()


def limit_teardown() -> None:
    """End this process in a while, whatever it waits for. In this build the middleware now and then does not come back
    from its end; what the nodes had to say is said by then.
    """
    faulthandler.dump_traceback_later(TEARDOWN_S, exit=True)


def run(factory: Callable[[], ContractNode], arguments: list[str] | None = None) -> int:
    """Main of a node's process: start rclpy, make the node, spin, clean up. Returns the exit status."""
    stop = StopFlag().install()
    rclpy.init(args=arguments if arguments is not None else sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node: ContractNode | None = None
    try:
        node = factory()
        return spin([node], stop, when_closed=limit_teardown)
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
        faulthandler.cancel_dump_traceback_later()
