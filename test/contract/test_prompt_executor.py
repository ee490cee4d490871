"""An executor with more to do than it can: what it has not got to does not hold up what comes."""

import gc
import weakref
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import String

from domains import domain_to_keep
from sojourn_contract.prompt_executor import PromptExecutor

ROUNDS = 300


class Flooded:
    """A node that hears two messages more for each that it takes, and a word on another topic after some."""

    def __init__(self, context: Context) -> None:
        self.node = Node("flooded", context=context, start_parameter_services=False)
        self.flood = self.node.create_publisher(String, "flood", 10)
        self.word = self.node.create_publisher(String, "word", 10)
        self.node.create_subscription(String, "flood", self._take, 10)
        self.node.create_subscription(String, "word", self._hear, 10)
        self.taken = 0
        self.words: list[str] = []

    def _take(self, _: Any) -> None:
        self.taken += 1
        if self.taken < ROUNDS:
            for _ in range(2):
                self.flood.publish(String(data="more"))
        if self.taken == ROUNDS // 2:
            self.word.publish(String(data="a word"))

    def _hear(self, message: String) -> None:
        self.words.append(message.data)


@pytest.fixture
def context() -> Iterator[Context]:
    found = Context()
    rclpy.init(args=[], context=found, domain_id=domain_to_keep())
    yield found
    rclpy.shutdown(context=found)


def events_until_heard(context: Context, most_delay_s: float) -> int:
    """Turns of the executor from when the word is said until it is heard."""
    flooded, executor = Flooded(context), PromptExecutor(context, most_delay_s)
    executor.add_node(flooded.node)
    try:
        for _ in range(200):  # until both ends have met
            executor.spin_once(timeout_sec=0.01)
        flooded.flood.publish(String(data="the first"))
        turns = 0
        for _ in range(20 * ROUNDS):
            executor.spin_once(timeout_sec=0.1)
            turns += flooded.taken >= ROUNDS // 2 and not flooded.words
            if flooded.words:
                break
        assert flooded.words == ["a word"]
        return turns
    finally:
        executor.remove_node(flooded.node)
        executor.shutdown()
        flooded.node.destroy_node()


def test_what_comes_is_heard_though_much_was_before_it(context: Context) -> None:
    """It was heard after all of that, however old, for which the ROS library keeps an event each."""
    late = events_until_heard(context, most_delay_s=1e9)
    soon = events_until_heard(context, most_delay_s=0.0)
    assert soon < 10 < ROUNDS // 4 < late


def test_nothing_is_lost_that_the_histories_hold_and_all_is_heard_as_it_came(context: Context) -> None:
    """Thrown away again and again, each time with messages of two topics in it."""
    node = Node("hears", context=context, start_parameter_services=False)
    heard: list[str] = []
    said = {name: node.create_publisher(String, name, 10) for name in ("one", "other")}
    for name in said:
        node.create_subscription(String, name, lambda message: heard.append(message.data), 10)
    executor = PromptExecutor(context, most_delay_s=0.0)
    executor.add_node(node)
    try:
        for _ in range(200):
            executor.spin_once(timeout_sec=0.01)
        for number in range(100):
            for part in "abc":
                for name, sender in said.items():
                    sender.publish(String(data=f"{number} {part} {name}"))
            while len(heard) < 6 * (number + 1):
                executor.spin_once(timeout_sec=0.5)
        assert heard == [f"{number} {part} {name}" for number in range(100) for part in "abc" for name in said]
    finally:
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()


def test_nothing_is_left_of_one_that_has_thrown_a_queue_away(context: Context) -> None:
    """The ROS library never lets go of what waits in it: it kept the executor, and by that the readers of its nodes."""
    executor = PromptExecutor(context, most_delay_s=0.0)
    for _ in range(20):
        executor.spin_once(timeout_sec=0.0)
        executor._begin_anew()
    gone = weakref.ref(executor), weakref.ref(executor._events)
    del executor
    gc.collect()
    assert [one() for one in gone] == [None, None]
