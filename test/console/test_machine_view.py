"""What of a drawn machine is sent to browsers: what has changed, and no more."""

import numpy as np

from sojourn_console.views.machine_view import LEAST_WAY, SentRows


class Drawn:
    """One thing that notes what is sent."""

    def __init__(self) -> None:
        self.sent: list[list[float]] = []

    def __setattr__(self, name: str, value: object) -> None:
        if name == "position":
            self.sent.append(np.asarray(value).tolist())
        super().__setattr__(name, value)


def test_only_what_has_moved_is_sent() -> None:
    body, wheel = Drawn(), Drawn()
    rows = SentRows([body, wheel], "position", LEAST_WAY, 3)
    rows.send(np.zeros((2, 3)))
    rows.send(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    rows.send(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.5 * LEAST_WAY]]))
    assert body.sent == [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    assert wheel.sent == [[0.0, 0.0, 0.0]]


def test_small_changes_add_up_until_they_are_sent() -> None:
    wheel = Drawn()
    rows = SentRows([wheel], "position", LEAST_WAY, 3)
    for step in range(11):
        rows.send(np.array([[0.4 * step * LEAST_WAY, 0.0, 0.0]]))
    last = 10 * 0.4 * LEAST_WAY
    assert 2 < len(wheel.sent) < 11
    assert abs(wheel.sent[-1][0] - last) < LEAST_WAY
