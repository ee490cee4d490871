"""One direction of a link, against laws that any link keeps, and by hand."""

import math
from collections import Counter
from collections.abc import Iterator
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.timing import NANOSECONDS
from sojourn_physics.link.channel import Channel, ChannelState, OpenAt, Packet
from sojourn_physics.link.times import Times
from sojourn_physics.link.window import NEVER, AnyOf

ALWAYS: OpenAt = lambda time: (True, NEVER)  # noqa: E731
SECOND = NANOSECONDS

offers = st.lists(
    st.tuples(
        st.integers(0, 3 * SECOND),  # before the next
        st.integers(1, 5000),  # bits
        st.integers(0, 3),  # priority
        st.sampled_from("ab"),
        st.none() | st.integers(0, 20 * SECOND),  # to its deadline
    ),
    max_size=25,
)
windows = st.lists(st.tuples(st.integers(0, 60 * SECOND), st.integers(1, 20 * SECOND)), max_size=3)


def opening(spans: list[tuple[int, int]]) -> OpenAt:
    """Open in each (begin, length), always without any."""
    together = AnyOf([Times(begin, length, None) for begin, length in spans])
    return lambda time: together.at(time, 0.0, 0.0)


@given(offers, windows, st.sampled_from((500.0, 4000.0, math.inf)), st.integers(0, 30 * SECOND), st.integers(1, 3))
def test_laws_of_any_link(
    said: list[tuple[int, int, int, str, int | None]],
    spans: list[tuple[int, int]],
    rate: float,
    light: int,
    keep: int,
) -> None:
    """Nothing comes from nowhere or gets lost on paper; nothing is earlier than light, later than its deadline, out of
    its window or faster than the bandwidth.
    """
    channel, state, open_at = Channel(rate, 0.3, stream=7), ChannelState(), opening(spans)
    now, offered = 0, dict[int, int]()
    arrived, sent, expired = list[tuple[int, Packet]](), list[tuple[int, Packet]](), 0
    for wait, bits, priority, name, patience in [*said, (200 * SECOND, 1, 0, "last", None)]:
        now += wait
        state, news = channel.advanced(state, now, light, open_at)
        arrived += news.arrived
        sent += news.sent
        expired += len(news.expired)
        packet = Packet("x", bits, priority, name, keep, None if patience is None else now + patience)
        state, packet = channel.offered(state, packet)
        offered[packet.number] = now
        tally = state.tally
        on_the_way = len(state.waiting) + len(state.flying) + (state.sending is not None)
        ended = tally.arrived + tally.lost + tally.expired + tally.dropped + tally.cancelled
        assert tally.offered == len(offered) == ended + on_the_way
    assert (len(arrived), expired) == (state.tally.arrived, state.tally.expired)
    left = {packet.number: time for time, packet in sent}
    for time, packet in arrived:
        assert time == left[packet.number] + light >= offered[packet.number] + light
        assert packet.deadline is None or time <= packet.deadline
        assert not channel.is_lost(packet.number)
    for time, packet in sent:
        is_open, _ = open_at(time)
        before, _ = open_at(time - 1) if time else (is_open, 0)
        assert is_open or before
        if not math.isinf(rate):
            assert time - offered[packet.number] >= packet.bits / rate * SECOND - 1
    assert state.bits_sent <= sum(bits for _, bits, *_ in said) + 1
    if not math.isinf(rate):
        assert state.bits_sent <= rate * open_time(open_at, now) / SECOND * (1.0 + 1e-9) + 1e-6


def open_time(open_at: OpenAt, end: int) -> int:
    """How long it has been open [ns]."""
    time = total = 0
    while time < end:
        is_open, until = open_at(time)
        total += (min(until, end) - time) * is_open
        time = until
    return total


@given(offers, windows, st.lists(st.integers(1, 10 * SECOND), max_size=30))
def test_how_often_one_looks_makes_no_difference(
    said: list[tuple[int, int, int, str, int | None]], spans: list[tuple[int, int]], looks: list[int]
) -> None:
    channel, open_at = Channel(2000.0, 0.2, stream=3), opening(spans)
    both = []
    for pauses in ([], looks):
        state, now, arrived = ChannelState(), 0, list[tuple[int, int]]()
        for _, bits, priority, name, _ in said:
            state, _ = channel.offered(state, Packet("x", bits, priority, name, keep=50))
        for pause in [*pauses, 500 * SECOND - sum(pauses)]:
            now += pause
            state, news = channel.advanced(state, now, SECOND, open_at)
            arrived += [(packet.number, time) for time, packet in news.arrived]
        both.append((arrived, state.tally))
    one, other = both
    assert one[1] == other[1] and [number for number, _ in one[0]] == [number for number, _ in other[0]]
    for (_, time), (_, again) in zip(*(each[0] for each in both), strict=True):
        assert abs(time - again) <= 2 * len(looks) + 2  # each look rounds to a nanosecond


def test_the_first_in_priority_goes_first_and_what_has_begun_goes_on() -> None:
    channel, state = Channel(1000.0), ChannelState()
    state, _ = channel.offered(state, Packet("image", 1000, 5, "image"))
    state, _ = channel.advanced(state, SECOND // 2, 0, ALWAYS)
    for content, priority in (("status", 3), ("stop", 0), ("later stop", 0)):
        state, _ = channel.offered(state, Packet(content, 500, priority, content))
    state, news = channel.advanced(state, 10 * SECOND, 0, ALWAYS)
    assert [(packet.content, time / SECOND) for time, packet in news.arrived] == [
        ("image", 1.0),
        ("stop", 1.5),
        ("later stop", 2.0),
        ("status", 2.5),
    ]


def begun(channel: Channel, every: list[tuple[int, int]], looks: int, look: int) -> Iterator[tuple[set[int], set[int]]]:
    """Names of which a packet has begun to be sent from each look to the next, and those that have waited all the time.

    Args:
        every: of each name bits, and looks from one packet to the next. look: time between two [ns].
    """
    state = ChannelState()
    for number in range(looks):
        for name, (bits, wait) in enumerate(every):
            if number % wait == 0:
                state, _ = channel.offered(state, Packet(name, bits, name=str(name)))
        before = {packet.content for packet in state.waiting}
        state, _ = channel.advanced(state, (number + 1) * look, 0, ALWAYS)
        after = {packet.content for packet in state.waiting}
        yield before - after, before & after


@given(st.lists(st.tuples(st.integers(1, 6000), st.integers(1, 12)), min_size=2, max_size=5))
def test_among_equals_none_waits_while_another_is_sent_twice(every: list[tuple[int, int]]) -> None:
    passed_by: dict[tuple[int, int], int] = {}
    for gone, kept in begun(Channel(16000.0), every, 200, SECOND // 10):
        passed_by = {(name, other): count for (name, other), count in passed_by.items() if name in kept}
        for pair in product(kept, gone):
            passed_by[pair] = passed_by.get(pair, 0) + 1
        assert max(passed_by.values(), default=0) <= 1


@pytest.mark.parametrize(
    ("rate", "every", "look", "looks"),
    [(1000.0, [(900, 1)] * 2, SECOND, 120), (16000.0, [(5600, 1), (3000, 1), (3000, 1)], SECOND // 10, 1200)],
)
def test_equals_are_sent_equally_often(rate: float, every: list[tuple[int, int]], look: int, looks: int) -> None:
    """The one that came first was sent alone, or none was: who comes often lost its turn each time."""
    counts = Counter(name for gone, _ in begun(Channel(rate), every, looks, look) for name in gone)
    assert len(counts) == len(every) and max(counts.values()) - min(counts.values()) <= 1
    sent = sum(bits * counts[name] for name, (bits, _) in enumerate(every))
    assert sent >= rate * look * looks / SECOND - max(bits for bits, _ in every)


def test_what_is_dropped_leaves_its_turn_to_the_next_of_its_name() -> None:
    """And what is new goes behind all that was there before it, where others of its name still wait."""
    channel, state = Channel(1000.0), ChannelState()
    for content in ("a1", "b1", "a2", "b2", "a3"):
        state, _ = channel.offered(state, Packet(content, 100, name=content[0], keep=2))
    assert [packet.content for packet in state.waiting] == ["a2", "b1", "b2", "a3"] and state.tally.dropped == 1


def test_what_the_window_cuts_goes_on_in_the_next() -> None:
    """3000 bits at 1000 bit/s, two seconds of each ten: it has left at 11 s, one light time before it arrives."""
    row = Times(0, 2 * SECOND, 10 * SECOND)
    channel = Channel(1000.0)
    state, _ = channel.offered(ChannelState(), Packet("x", 3000))
    state, news = channel.advanced(state, 60 * SECOND, 4 * SECOND, lambda time: row.at(time, 0.0, 0.0))
    assert [time for time, _ in news.sent] == [11 * SECOND] and [time for time, _ in news.arrived] == [15 * SECOND]


def test_what_would_come_too_late_is_not_sent_and_what_comes_too_late_not_given() -> None:
    channel, closed = Channel(1000.0), opening([(50 * SECOND, 100 * SECOND)])
    state, _ = channel.offered(ChannelState(), Packet("waits too long", 1000, deadline=40 * SECOND))
    state, news = channel.advanced(state, 41 * SECOND, 0, closed)
    assert [(packet.content, was_sent) for _, packet, was_sent in news.expired] == [("waits too long", False)]
    cut = opening([(41 * SECOND, SECOND), (100 * SECOND, 50 * SECOND)])
    state, _ = channel.offered(state, Packet("is cut", 2000, deadline=60 * SECOND))
    state, news = channel.advanced(state, 200 * SECOND, SECOND, cut)
    ((time, packet, was_sent),) = news.expired
    assert (packet.content, was_sent, time) == ("is cut", True, 102 * SECOND) and not news.arrived


def test_only_what_waits_can_be_called_back() -> None:
    channel, state = Channel(1000.0), ChannelState()
    numbers = []
    for name in "ab":
        state, packet = channel.offered(state, Packet(name, 1000, name=name))
        numbers.append(packet.number)
    state, _ = channel.advanced(state, SECOND // 2, 0, ALWAYS)
    state, first = channel.cancelled(state, numbers[0])
    state, second = channel.cancelled(state, numbers[1])
    state, news = channel.advanced(state, 9 * SECOND, 0, ALWAYS)
    assert (first, second) == (False, True) and [packet.content for _, packet in news.arrived] == ["a"]


def test_as_many_are_lost_as_is_said() -> None:
    channel = Channel(loss=0.2, stream=11)
    count = sum(channel.is_lost(number) for number in range(5000))
    assert count / 5000 == pytest.approx(0.2, abs=4.0 * math.sqrt(0.2 * 0.8 / 5000))
