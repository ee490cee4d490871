"""How long nothing has been heard, as far as it could have been."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.silence import LONGEST_LOOK_S, LOST_S, Silence


@given(st.lists(st.floats(0.0, LONGEST_LOOK_S), max_size=40), st.integers(0, 40))
def test_looked_at_often_it_is_the_time_since_something_was_heard(steps: list[float], heard: int) -> None:
    now = 5.0
    silence, since, lasted = Silence(now), 0.0, 0.0
    for number, step in enumerate(steps):
        if number == heard:
            silence.ends()
            since = 0.0
        now += step
        since += step
        lasted = silence.until(now)
        assert lasted == pytest.approx(since, abs=1e-9)


def test_a_process_that_was_held_up_takes_nobody_for_silent() -> None:
    silence = Silence(1.0)
    silence.until(1.02)
    assert silence.until(1.02 + 10.0 * LOST_S) == pytest.approx(0.02 + LONGEST_LOOK_S)
