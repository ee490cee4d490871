"""Guarded moves of the explorer's arm on rock and on soil, judged by the plant's truth."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest


@pytest.mark.parametrize(("soil", "force"), [("rigid_rock", 10.0), ("lunar_nominal", 10.0)])
def test_it_stops_where_it_touches_and_stays_in_touch(rover_arm: Callable[..., Any], soil: str, force: float) -> None:
    """At 1 cm/s: the tip goes on by less than 2 mm after the threshold, the force by less than 20 N, and then holds."""
    rover = rover_arm(f"soil={soil}")
    rover.over_ground(1.2, 0.0, 0.02)
    start = len(rover.log)
    report = rover.task("guarded_move", 20.0, force=force, speed=0.01)
    assert report.doing.state == "reached", report
    pressed, height = rover.since("force", start)[:, 2], rover.since("tip", start)[:, 2]
    crossed = int(np.argmax(pressed > force))
    assert crossed > 0
    assert pressed.max() - force < 20.0
    assert height[crossed] - height[crossed:].min() < 0.002
    told = report.doing.figures
    assert told["overshoot_n"] == pytest.approx(pressed.max() - force, abs=1.5)
    assert told["overshoot_m"] < 0.002
    held = len(rover.log)
    rover.run(6.0)
    assert rover.since("force", held)[:, 2] == pytest.approx(force, abs=2.5)


def test_without_ground_it_gives_up(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=lunar_nominal")
    report = rover.task("guarded_move", 20.0, distance=0.03, speed=0.02)
    assert report.doing.state == "failed" and "no contact of 10 N within 30 mm" in report.doing.reason
    place = rover.log[-1]["tip"]
    rover.run(1.0)
    assert rover.log[-1]["tip"] == pytest.approx(place, abs=2e-3)
