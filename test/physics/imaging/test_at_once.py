"""Calls side by side: their results in order, and what fails."""

import threading

import pytest

from sojourn_physics.imaging.at_once import at_once


def test_results_come_in_the_order_of_the_calls_and_the_first_is_made_here() -> None:
    threads = at_once([threading.current_thread for _ in range(3)])
    assert threads[0] is threading.current_thread() and threads[0] not in threads[1:]
    assert at_once([lambda k=k: k for k in range(5)]) == list(range(5))
    assert at_once([lambda: 7]) == [7]


@pytest.mark.parametrize("place", [0, 1])
def test_what_fails_is_raised_when_all_have_ended(place: int) -> None:
    """A call that went on would change its arrays under whoever makes the next ones."""
    ended = threading.Event()
    may_end = threading.Timer(0.2, ended.set)
    may_end.start()

    def fails() -> None:
        raise ValueError("no light")

    def takes_long() -> None:
        ended.wait()

    with pytest.raises(ValueError, match="no light"):
        at_once([fails, takes_long] if place == 0 else [takes_long, fails])
    assert ended.is_set()
