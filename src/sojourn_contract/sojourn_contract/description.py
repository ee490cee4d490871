"""The contract as plain data: for JSON, for the page, and for the bag, which says under which one it was recorded."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, replace
from math import isfinite
from typing import Any

from sojourn_contract import qos
from sojourn_contract.delivery import Delivery, Loss
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import INFINITY, FieldRule, Reliability, Topic
from sojourn_contract.topics import TOPICS

CONTRACT_VERSION = 1
"""Raised by hand when what nodes must do changes in a way that the table does not show."""
LEAP = "longest_leap_periods"
"""Key of the control periods by which the clock of a run may leap, where it does."""
_INTERFACE = ("type", "publisher", "subscribers", "rate_hz", "lag_periods", "recorded", "qos", "frames", "child_frame")
"""What two sides must agree on, with the units of the fields. Ranges, ages and tolerances may be tuned."""


def contract_data(rows: Iterable[Topic] = TOPICS) -> dict[str, Any]:
    """The contract of a table in JSON values."""
    topics = {row.name: _topic(row) for row in rows}
    leaps = {LEAP: rows.longest_leap} if isinstance(rows, TopicTable) and rows.longest_leap else {}
    return leaps | {
        "version": CONTRACT_VERSION,
        "digest": _digest(topics),
        "control_period_s": CONTROL_PERIOD_S,
        "topics": topics,
    }


def row_of_data(name: str, data: Mapping[str, Any]) -> Topic:
    """The row of a topic that only another installation knows, from its contract: enough to read and judge it by.

    Raises KeyError, TypeError, ValueError, AttributeError for what is no topic of a contract.
    """
    rate, age = data["rate_hz"], data["max_age_s"]
    best_effort = str(data["qos"]["lockstep"]).startswith(Reliability.BEST_EFFORT.value)
    row = Topic(
        name,
        str(data["type"]),
        str(data["publisher"]),
        tuple(data["subscribers"]),
        0 if rate is None else round(1.0 / (float(rate) * CONTROL_PERIOD_S)),
        INFINITY if age is None else float(age),
        str(data["meaning"]),
        tuple(_rule(field) for field in data["fields"]),
        Reliability.BEST_EFFORT if best_effort else Reliability.RELIABLE,
        int(data["lag_periods"]),
        bool(data["recorded"]),
        tuple(data["frames"]),
        str(data["child_frame"]),
        str(data["joints"]),
        on_demand=bool(data.get("on_demand")),
    )
    return delivered_by_data(row, data)


def heard_by_data(row: Topic, data: Mapping[str, Any]) -> Topic:
    """A row that a sensor brings, with who acts on it in a run, as its contract says: that depends on what the drive of
    the machine goes by, see `stereo_pair`. Raises as `row_of_data`.
    """
    return replace(row, subscribers=tuple(data["subscribers"]))


def delivered_by_data(row: Topic, data: Mapping[str, Any]) -> Topic:
    """A row with what a contract says of the delivery of its messages, if anything. Raises as `row_of_data`."""
    told = data.get("delivery")
    if told is None:
        return row
    delivery = Delivery(**{**told, "losses": tuple(Loss(**each) for each in told["losses"])})
    return replace(row, every=delivery.every, max_age_s=float(data["max_age_s"]), delivery=delivery)


def _rule(data: Mapping[str, Any]) -> FieldRule:
    bounds = {
        "low": -INFINITY if data["low"] is None else data["low"],
        "high": INFINITY if data["high"] is None else data["high"],
        "rate_tolerance": INFINITY if data["rate_tolerance"] is None else data["rate_tolerance"],
    }
    return FieldRule(**{**data, **bounds})


def contract_name(data: Mapping[str, Any]) -> str:
    """Version and digest in short."""
    return f"{data.get('version', '?')}-{data.get('digest', '?')}"


def contract_differences(theirs: Mapping[str, Any], ours: Mapping[str, Any]) -> Iterator[str]:
    """In words, how another contract differs from ours; nothing where both sides may talk."""
    if theirs.get("version") != ours["version"]:
        yield f"its version is {theirs.get('version')}, ours {ours['version']}"
    their_topics: Mapping[str, Any] = theirs.get("topics", {})
    our_topics: Mapping[str, Any] = ours["topics"]
    for name in our_topics:
        if name not in their_topics:
            yield f"{name} is not in it"
    for name, topic in their_topics.items():
        if name not in our_topics:
            yield f"{name} is only in it"
            continue
        before, now = _interface(topic), _interface(our_topics[name])
        for key in now:
            then, ours_now = before.get(key), now[key]
            if then == ours_now:
                continue
            if isinstance(then, Mapping) and isinstance(ours_now, Mapping):  # say no more than what differs
                apart = [each for each in {**then, **ours_now} if then.get(each) != ours_now.get(each)]
                then = {each: then.get(each) for each in apart}
                ours_now = {each: ours_now.get(each) for each in apart}
            yield f"{name}: {key} is {_words(then)}, ours {_words(ours_now)}"


def _digest(topics: Mapping[str, Any]) -> str:
    """Short hash of what two sides must agree on."""
    agreed = [CONTRACT_VERSION, CONTROL_PERIOD_S, {name: _interface(topic) for name, topic in topics.items()}]
    return hashlib.sha256(json.dumps(agreed, sort_keys=True).encode()).hexdigest()[:12]


def _interface(topic: Mapping[str, Any]) -> dict[str, Any]:
    units = {rule["path"]: f"{rule['unit']} {rule['frame']}".strip() for rule in topic.get("fields", ())}
    delivery = {"delivery": topic["delivery"]} if "delivery" in topic else {}
    return {key: topic.get(key) for key in (*_INTERFACE, "joints")} | {"units": units} | delivery


def _topic(row: Topic) -> dict[str, Any]:
    return {
        "type": row.type,
        "publisher": row.publisher,
        "subscribers": list(row.subscribers),
        "rate_hz": None if row.is_event else 1.0 / (row.every * CONTROL_PERIOD_S),
        "max_age_s": _finite(row.max_age_s),
        "lag_periods": row.lag,
        "recorded": row.logged,
        "qos": {"lockstep": _qos(row, lockstep=True), "realtime": _qos(row, lockstep=False)},
        "frames": list(row.frames),
        "child_frame": row.child_frame,
        "joints": row.joints,
        "meaning": row.meaning,
        "fields": [_field(rule) for rule in row.fields],
    } | _if_any(row)


def _if_any(row: Topic) -> dict[str, Any]:
    """What most rows do not have, so that they stay as they were."""
    told = {} if row.delivery is None else {"delivery": _told(row.delivery)}
    return told | ({"on_demand": True} if row.on_demand else {})


def _qos(row: Topic, lockstep: bool) -> str:
    reliability = Reliability.BEST_EFFORT if qos.is_best_effort(row, lockstep) else Reliability.RELIABLE
    return f"{reliability.value}, keep last {qos.depth(row, lockstep)}"


def _field(rule: FieldRule) -> dict[str, Any]:
    """With `infinite` only where it is true: rows without it stay as they were."""
    return {
        "path": rule.path,
        "unit": rule.unit,
        "frame": rule.frame,
        "low": _finite(rule.low),
        "high": _finite(rule.high),
        "tolerance": rule.tolerance,
        "optional": rule.optional,
        "rate_of": rule.rate_of,
        "rate_tolerance": _finite(rule.rate_tolerance),
        "rate_window": rule.rate_window,
        "rate_part": rule.rate_part,
        "rate_spread": rule.rate_spread,
    } | ({"infinite": True} if rule.infinite else {})


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _words(value: Any) -> str:
    return json.dumps(value) if isinstance(value, dict | list) else repr(value)


def _told(delivery: Delivery) -> dict[str, Any]:
    """A delivery as data; losses without a word on frozen stamps where there are none, as before there could be."""
    told = asdict(delivery)
    losses = [{key: value for key, value in loss.items() if value or key != "frozen"} for loss in told["losses"]]
    return {**told, "losses": losses}
