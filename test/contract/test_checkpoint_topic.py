"""States on their way: in parts and together again."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.checkpoint_topic import PART_CHARACTERS, StateParts, as_bytes, as_text, state_messages
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import Counters, Heartbeat, read_heartbeats, status_message


def beats_of(role: str, text: str) -> list[Heartbeat]:
    counters = Counters({"/odom": 7})
    return [beat for message in state_messages(role, 40_000_000, counters, text) for beat in read_heartbeats(message)]


@given(st.permutations(range(3)), st.permutations(range(2)))
def test_parts_of_several_come_in_any_order(ours: Sequence[int], others: Sequence[int]) -> None:
    texts = {"drive": "d" * (2 * PART_CHARACTERS) + "end", "arm": "a" * PART_CHARACTERS + "b"}
    parts, whole = StateParts(), {}
    drive, arm = beats_of("drive", texts["drive"]), beats_of("arm", texts["arm"])
    for beat in [drive[ours[0]], arm[others[0]], drive[ours[1]], arm[others[1]], drive[ours[2]]]:
        text = parts.take(beat)
        if text is not None:
            whole[beat.role] = text
    assert whole == texts
    assert all(beat.published == {"/odom": 7} for beat in drive)


def test_an_empty_state_is_one_part() -> None:
    (beat,) = beats_of("drive", "")
    assert StateParts().take(beat) == ""


@pytest.mark.parametrize(("part", "of"), [("0", "1"), ("3", "2"), ("1", "999999"), ("one", "1"), ("-1", "1"), ("", "")])
def test_what_is_no_part_is_refused(part: str, of: str) -> None:
    (beat,) = read_heartbeats(status_message(20, "drive", {"state": "checkpoint", "part": part, "of": of}))
    with pytest.raises(RefusedMessageError, match="one of at most 4096 parts"):
        StateParts().take(beat)


@given(st.binary())
def test_bytes_go_as_text(data: bytes) -> None:
    assert as_bytes(as_text(data)) == data


def test_a_text_of_other_characters_is_refused() -> None:
    with pytest.raises(RefusedMessageError, match="allowed is base64"):
        as_bytes("{not base64}")
