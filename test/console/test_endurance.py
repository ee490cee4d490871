"""A bag on end, and what is told of it."""

import re
from pathlib import Path

import numpy as np
import pytest

from sojourn_bags.reading import Bag
from sojourn_console.bench import main
from sojourn_console.endless_feed import EndlessFeed
from sojourn_console.endurance import Endurance, endurance, growth
from sojourn_console.errors import ConsoleError
from sojourn_console.world import World

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"


def test_time_goes_on_when_the_bag_begins_anew(reference: Bag, world: World) -> None:
    feed = EndlessFeed(reference, world.table)
    feed.want(["/odom"], ["/odom"])
    length = (feed.end - feed.begin) * 1e-9
    times: list[int] = []
    for _ in range(25):
        feed.advance(0.1 * length)
        times += [one.time for one in feed.poll()]
    assert feed.laps == 2 and not feed.has_jumped()
    assert (np.diff(times) > 0).all() and times[-1] - times[0] > 2.0e9 * length


def test_growth_is_that_of_the_run_and_not_of_its_beginning() -> None:
    hours = np.linspace(0.0, 8.0, 60)
    filling = 100.0 * np.minimum(hours, 1.0)
    assert growth(hours.tolist(), (300.0 + filling).tolist()) == pytest.approx(0.0, abs=1e-9)
    assert growth(hours.tolist(), (300.0 + filling + 2.5 * hours).tolist()) == pytest.approx(2.5)
    assert Endurance(864_000, 3.0, 400.0, -0.1).lines(30.0)[1:] == [
        "a scene takes 3.00 ms of the processor: 9 % of a core",
        "memory 400 MB at the end, growing by -0.1 MB an hour",
    ]


def test_a_run_that_is_broken_off_is_judged_by_what_it_has() -> None:
    """Of two minutes, which are 3600 scenes with a sample every 60."""
    told: list[str] = []
    found = endurance(REFERENCE, 1.0 / 30.0, told.append, lambda: len(told) < 6)
    assert found.scenes == 360 and len(told) == 6 and re.fullmatch(r" *0\.00 h of 0\.0333333: \d+\.\d MB", told[0])
    with pytest.raises(ConsoleError, match="broken off after 0 scenes: growth is told from 300 on"):
        endurance(REFERENCE, 1.0 / 30.0, told.append, lambda: False)


def test_what_is_no_bag_is_refused() -> None:
    with pytest.raises(ConsoleError, match="nowhere"):
        main(["nowhere"])
