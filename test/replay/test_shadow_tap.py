"""What a shadow is given of a run in which somebody sends a goal by hand: it comes in the period in which our node
took it, wherever it stands among the other messages.
"""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from theme_bags import bag_of

from sojourn_bags.contract_version import table_of_bag
from sojourn_bags.provenance import run_of
from sojourn_bags.replay_script import HEARTBEATS, ReplayPeriod
from sojourn_bags.shadow_tap import Tap
from sojourn_contract import stamps
from sojourn_contract.codecs import decode, encode
from sojourn_contract.heard import Took, took_values
from sojourn_contract.stamps import CONTROL_PERIOD_NS

ROLE, GOAL = "drive", "/goal_pose"
BAG = "themes/by_hand"
Said = list[tuple[str, bytes]]


class Stack:
    """Takes the place of the ROS node on which a tap listens."""

    def __init__(self) -> None:
        self.listeners: dict[str, list[Any]] = {}

    def create_subscription(self, _kind: Any, name: str, take: Any, _profile: Any, raw: bool) -> None:
        assert raw
        self.listeners.setdefault(f"/{name}", []).append(take)


def tap_of(stack: Stack) -> Tap:
    bag = bag_of(BAG)
    return Tap(ROLE, run_of(bag)["participants"].split(","), table_of_bag(bag), True, stack)  # type: ignore[arg-type]


def said() -> Said:
    """All that a tap hears of the bag, in the order of the file; without goals, which the scripted operator sent."""
    bag, stack = bag_of(BAG), Stack()
    tap = tap_of(stack)
    events = {row.name for row in tap.inputs if row.is_event}
    names = [name for name in stack.listeners if name in bag and name not in events]
    return [(name, data) for _, name, data in sorted(
        (bag[name].places[index], name, bag[name].data[index]) for name in names for index in range(len(bag[name]))
    )]  # fmt: skip


def with_goal(messages: Said, place: int, late: int, told: bool) -> tuple[Said, int, bytes]:
    """A goal by hand at this place, which the node takes `late` periods after the newest stamp there; the messages with
    it and with the heartbeat that tells of it, the period and the goal.
    """
    table = table_of_bag(bag_of(BAG))
    newest = max(stamps.from_cdr(data) for name, data in messages[:place] if name == "/joint_states")
    goal = bag_of(BAG)[GOAL].data[0]
    goal = encode(table.topic(GOAL), decode(table.topic(GOAL), goal)._replace(stamp=newest - 7))
    at = newest + late * CONTROL_PERIOD_NS
    result: Said = []
    done = not told
    for index, (name, data) in enumerate(messages):
        if index == place:
            result.append((GOAL, goal))
        if not done and name == HEARTBEATS and index > place and stamps.from_cdr(data) >= at:
            array = decode(table.topic(name), data)
            if array.status[0].name == ROLE:
                extra = tuple(took_values([Took(GOAL, newest - 7, at)]).items())
                status = array.status[0]._replace(values=(*array.status[0].values, *extra))
                data, done = encode(table.topic(name), array._replace(status=(status,))), True
        result.append((name, data))
    assert done
    return result, at // CONTROL_PERIOD_NS, goal


def played(messages: Sequence[tuple[str, bytes]]) -> list[ReplayPeriod]:
    stack, found = Stack(), list[ReplayPeriod]()
    tap = tap_of(stack)
    for name, data in messages:
        for take in stack.listeners.get(name, ()):
            take(data)
        while (step := tap.next_step()) is not None:
            found.append(step)
    tap.close()
    while (step := tap.next_step()) is not None:
        found.append(step)
    return found


@settings(max_examples=12, deadline=None)
@given(part=st.floats(0.05, 0.7), late=st.integers(0, 2))
def test_a_goal_by_hand_comes_when_our_node_took_it(part: float, late: int) -> None:
    messages = said()
    alone = played(messages)
    heard, at, goal = with_goal(messages, int(part * len(messages)), late, told=True)
    steps = played(heard)
    assert [step.period for step in steps] == [step.period for step in alone] == list(range(1, len(alone) + 1))
    assert [(step.period, step.by_hand) for step in steps if step.goals] == [(at, [(GOAL, goal)])]
    assert [step.inputs for step in steps] == [step.inputs for step in alone]


@pytest.mark.parametrize("part", [0.3, 0.95])
def test_one_of_which_the_node_never_tells_holds_nothing_up_for_ever(part: float) -> None:
    messages = said()
    heard, at, goal = with_goal(messages, int(part * len(messages)), 1, told=False)
    steps = played(heard)
    (given,) = [step for step in steps if step.goals]
    assert given.goals == [(GOAL, goal)] and given.untold == {GOAL} and abs(given.period - at) <= 1
    assert len(steps) == len(played(messages))
