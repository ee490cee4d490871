"""Bytes that somebody may send on a topic: serialised messages with some of them changed, cut off, or none at all."""

from functools import cache

from hypothesis import strategies as st
from rclpy.serialization import serialize_message

from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class

GARBAGE = {
    "/diagnostics": bytes.fromhex("00010000ffffffffffffffff"),
    "/odom": bytes.fromhex("0001000001000000002d3101ffffffff0000"),
}
"""As they were sent to nodes that did not survive them."""


@cache
def whole(row: Topic) -> bytes:
    """A message of the topic's type with something in every list that can be filled without knowing it."""
    message = message_class(row.type)()
    for name in ("name", "position", "velocity", "effort", "poses", "points", "status", "fields"):
        kind = message.get_fields_and_field_types().get(name, "")
        if kind == "sequence<string>":
            setattr(message, name, ["a", "b"])
        elif kind == "sequence<double>":
            setattr(message, name, [1.0, 2.0])
        elif kind.startswith("sequence<"):
            package, short = kind.removeprefix("sequence<").removesuffix(">").split("/")
            setattr(message, name, [message_class(f"{package}/{short}")() for _ in range(2)])
    return bytes(serialize_message(message))


@st.composite
def hostile(draw: st.DrawFn, row: Topic) -> bytes:
    """Bytes for a topic."""
    if draw(st.integers(0, 3)) == 0:
        return draw(st.one_of(st.binary(max_size=80), st.just(GARBAGE["/diagnostics"]), st.just(GARBAGE["/odom"])))
    data = bytearray(whole(row))
    for _ in range(draw(st.integers(0, 6))):
        place = draw(st.integers(0, len(data) - 1))
        data[place] = draw(st.sampled_from((0, 1, 2, 7, 63, 127, 128, 240, 255)))
    return bytes(data[: draw(st.integers(0, len(data)))] if draw(st.integers(0, 3)) == 0 else data)
