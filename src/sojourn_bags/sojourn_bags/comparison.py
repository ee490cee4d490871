"""Compares two sets of messages, field by field on every topic: two runs, or what a node said and should have said.

comparison = compare(read_bag("runs/a").topics, read_bag("runs/b").topics)
comparison.verdict, comparison.divergence(), comparison.field("/odom.pose.pose.position.x")

Messages belong together by stamp, and within a stamp by order. The tolerance of each field is that of the topic
table (`sojourn_contract.tolerance`).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.comparison_fields import compare_layouts
from sojourn_bags.comparison_match import MatchedMessages, match, stamps_of
from sojourn_bags.comparison_result import Comparison, TopicComparison
from sojourn_bags.comparison_tally import Tally
from sojourn_bags.comparison_text import compare_statuses
from sojourn_bags.messages import Messages
from sojourn_contract.flow import place_of
from sojourn_contract.stamps import seconds

_STATUSES = "diagnostic_msgs/msg/DiagnosticArray"
_JOINTS = "sensor_msgs/msg/JointState"
_JOINT_ARRAYS = ("position", "velocity", "effort", "name")


def compare(one: Mapping[str, Messages], other: Mapping[str, Messages]) -> Comparison:
    """Compare two sets of messages by topic.

    A topic that only one set has is compared with no messages. Raises ValueError for a message that is cut off.
    """
    names = sorted(one.keys() | other.keys(), key=lambda name: (place_of(name), name))
    topics = []
    matches: dict[str, MatchedMessages] = {}
    for name in names:
        left = one.get(name) or Messages(name, other[name].type)
        right = other.get(name) or Messages(name, one[name].type)
        matches[name] = match(left, right)
        topics.append(_compare_topic(left, right, matches[name]))
    whole = not any(topic.missing or topic.extra for topic in topics)
    return Comparison(tuple(topics), _order_differs_at(one, other, matches) if whole else None)


def until(messages: Mapping[str, Messages], stamp: int) -> dict[str, Messages]:
    """The messages whose log time is before `stamp` [ns]: of a bag that was cut off, what is surely complete."""
    found = {}
    for name, each in messages.items():
        count = int(np.searchsorted(np.array(each.log_times), stamp)) if each.log_times else 0
        found[name] = Messages(name, each.type, each.log_times[:count], each.data[:count], each.places[:count])
    return {name: each for name, each in found.items() if len(each)}


def _compare_topic(one: Messages, other: Messages, matched: MatchedMessages) -> TopicComparison:
    tally = Tally()
    if one.type != other.type and len(matched.one):
        tally.add_single("(type)", "type", 0, one.type, other.type, float("inf"), 0.0)
    else:
        # equal bytes are equal fields; what is not equal may still be padding, so it is looked at
        pairs = [
            pair
            for pair, (a, b) in enumerate(zip(matched.one.tolist(), matched.other.tolist(), strict=True))
            if one.data[a] != other.data[b]
        ]
        _compare_pairs(one, other, matched, pairs, tally)
        _compare_log_times(one, other, matched, tally)
    return TopicComparison(
        one.topic,
        len(one),
        len(other),
        len(matched.one),
        matched.missing,
        matched.extra,
        tally.fields(one.topic, matched.stamps, lambda path, pair, element: _label(one, matched, path, pair, element)),
    )


def _compare_pairs(one: Messages, other: Messages, matched: MatchedMessages, pairs: list[int], tally: Tally) -> None:
    if not pairs:
        return
    left = _chosen(one, matched.one[pairs])
    right = _chosen(other, matched.other[pairs])
    if one.type == _STATUSES:
        compare_statuses(left, right, pairs, tally)
    else:
        compare_layouts(left, right, np.array(pairs, dtype=np.int64), tally)


def _compare_log_times(one: Messages, other: Messages, matched: MatchedMessages, tally: Tally) -> None:
    """The period under which a recorder has filed a message; for a goal stamped zero it is that of its effect."""
    if not one.places or not other.places or not len(matched.one):
        return
    left = np.array(one.log_times, dtype=np.int64)[matched.one]
    right = np.array(other.log_times, dtype=np.int64)[matched.other]
    differences = np.abs(left - right) * 1e-9
    tally.add(
        "(log time)",
        "log time",
        np.arange(len(left)),
        left != right,
        differences,
        0.0,
        lambda row, _element: (seconds(int(left[row])), seconds(int(right[row]))),
    )


def _chosen(messages: Messages, indices: NDArray[np.int64]) -> Messages:
    return Messages(messages.topic, messages.type, data=[messages.data[index] for index in indices])


def _label(messages: Messages, matched: MatchedMessages, path: str, pair: int, element: int) -> str:
    """Name of an element of an array: of its joint, or its number."""
    if messages.type == _JOINTS and path in _JOINT_ARRAYS:
        names = messages.decode(int(matched.one[pair])).name
        if element < len(names):
            return f"[{names[element]}]"
    return f"[{element}]"


def _order_differs_at(
    one: Mapping[str, Messages], other: Mapping[str, Messages], matches: Mapping[str, MatchedMessages]
) -> tuple[str, int] | None:
    """The first message of the first set that stands at another place in the second."""
    found: list[tuple[int, str, int]] = []
    for name, matched in matches.items():
        left, right = one[name], other[name]
        if not left.places or not right.places:
            continue
        places = np.array(left.places)[matched.one]
        moved = np.flatnonzero(places != np.array(right.places)[matched.other])
        if moved.size:
            first = int(moved[np.argmin(places[moved])])
            found.append((int(places[first]), name, int(matched.stamps[first])))
    return min(found)[1:] if found else None


__all__ = ["compare", "stamps_of", "until"]
