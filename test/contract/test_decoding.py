"""Bytes that are no message of their topic: one refusal, whatever the ROS library or a check makes of them."""

from typing import Any

import pytest
from hostile_bytes import GARBAGE, hostile
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.checks import check_message
from sojourn_contract.decoding import decoded, hearing, refusing, stamp_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.topics import TOPICS, topic


@pytest.mark.parametrize("name", GARBAGE)
def test_what_the_ros_library_cannot_read_is_refused(name: str) -> None:
    with pytest.raises(RefusedMessageError, match=f"{name}.message = .* bytes: allowed is a serialised"):
        decoded(name, topic(name).type, GARBAGE[name])


@settings(max_examples=400, deadline=None)
@given(st.data())
def test_any_bytes_are_a_message_or_refused(data: st.DataObject) -> None:
    row = data.draw(st.sampled_from(TOPICS))
    told: list[Any] = []

    def take(message: Any) -> None:
        check_message(row.name, message)
        if row.publisher == "all":
            read_heartbeats(message)
        told.append(message)

    hear = hearing(row, take, told.append)
    content = data.draw(hostile(row))
    hear(content)
    assert len(told) == 1
    try:
        stamp_of(row.name, content)
    except RefusedMessageError as refusal:
        assert len(content) < 12 and refusal.topic == row.name


def test_an_error_of_a_check_is_a_refusal_with_its_reason() -> None:
    told = r"/odom.message = its content: allowed is sense \(no key\)"
    with pytest.raises(RefusedMessageError, match=told), refusing("/odom", "sense"):
        raise ValueError("no  key")


def test_a_count_of_endless_digits_is_none() -> None:
    """Python itself refuses to read more than 4300, with an error of its own."""
    with pytest.raises(RefusedMessageError):
        parse_tick("/goal_pose=" + "9" * 5000)
