"""Bytes that somebody may send on a topic, as Hypothesis draws them: see `sojourn_studies.hostile_messages`."""

from hypothesis import strategies as st

from sojourn_contract.topic_types import Topic
from sojourn_studies.hostile_messages import GARBAGE, LONGEST_GARBAGE, MOST_CHANGES, NASTY, whole


@st.composite
def hostile(draw: st.DrawFn, row: Topic) -> bytes:
    """Bytes for a topic."""
    if draw(st.integers(0, 3)) == 0:
        return draw(st.one_of(st.binary(max_size=LONGEST_GARBAGE), st.sampled_from(sorted(GARBAGE.values()))))
    data = bytearray(whole(row))
    for _ in range(draw(st.integers(0, MOST_CHANGES))):
        place = draw(st.integers(0, len(data) - 1))
        data[place] = draw(st.sampled_from(NASTY))
    return bytes(data[: draw(st.integers(0, len(data)))] if draw(st.integers(0, 3)) == 0 else data)
