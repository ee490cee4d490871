"""What the page costs, and whether it grows: see `bench.py`.

A bag is played on end to the page, scene by scene without a pause, as many as thirty a second make in the hours that
are asked for; nobody draws them. Told are the processor time of a scene, of which thirty make the share of a core that
the page's process takes, and the memory that the process holds (resident; Linux alone tells) over the
run: what it holds at the end over what it held after the first fifth, in which tracks, plots and caches fill. The line
through the last four fifths by least squares is the growth an hour. Each sample is told as it is taken, and a run that
is broken off (Ctrl-C) is judged by those that it has.
"""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rich

from sojourn_bags.reading import read_bag
from sojourn_bringup.process_state import memory_mb
from sojourn_console.endless_feed import EndlessFeed
from sojourn_console.errors import ConsoleError
from sojourn_console.frames import FRAMES
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.world import world_of_bag

SAMPLES = 60
FEWEST = 5
"""By which growth can be told."""
FILLING = 0.2
"""Part of the run in which what is bounded may fill."""


class Endurance(NamedTuple):
    """Of a page over some hours of a run."""

    scenes: int
    scene_ms: float
    """Processor time of one [ms]."""
    memory_mb: float
    """At the end [MB]."""
    growth_mb_per_hour: float

    def lines(self, frames: float) -> list[str]:
        """What was found, in words."""
        return [
            f"{self.scenes} scenes, {self.scenes / frames / 3600.0:.2f} h of thirty a second",
            f"a scene takes {self.scene_ms:.2f} ms of the processor: {0.1 * self.scene_ms * frames:.0f} % of a core",
            f"memory {self.memory_mb:.0f} MB at the end, growing by {self.growth_mb_per_hour:+.1f} MB an hour",
        ]


def growth(hours: Sequence[float], held: Sequence[float]) -> float:
    """Slope of the memory held [MB] over the hours, by least squares, without the filling [MB/h]."""
    begin = int(FILLING * len(hours))
    return float(np.polyfit(hours[begin:], held[begin:], 1)[0])


def endurance(bag: Path, hours: float, tell: Callable[[str], None], goes_on: Callable[[], bool]) -> Endurance:
    """Play a bag to a page for so long, or until it does not go on.

    Args:
        bag: a run's. hours: of scenes. tell: called with what each sample has found, in words. goes_on: asked before
            each scene.

    Raises:
        ConsoleError: broken off before growth could be told. BagsError: the bag cannot be read.
    """
    rich.get_console().quiet = True  # viser would print an address, without the token
    recorded = read_bag(bag)
    world = world_of_bag(recorded)
    feed = EndlessFeed(recorded, world.table)
    page = Page(GuardedServer("bench"), world, feed)
    scenes = max(SAMPLES, round(hours * 3600.0 * FRAMES))
    at, held, count = list[float](), list[float](), 0
    begin = time.process_time()
    try:
        while count < scenes and goes_on():
            count += 1
            feed.advance(1.0 / FRAMES)
            page.look()
            if count % (scenes // SAMPLES) == 0:
                at.append(count / FRAMES / 3600.0)
                held.append(memory_mb())
                tell(f"{at[-1]:6.2f} h of {hours:g}: {held[-1]:.1f} MB")
    except OSError as error:
        raise ConsoleError(f"memory is measured on Linux alone: {error}") from error
    finally:
        page.close()
    if len(held) < FEWEST:
        raise ConsoleError(f"broken off after {count} scenes: growth is told from {FEWEST * scenes // SAMPLES} on")
    took = 1e3 * (time.process_time() - begin) / count
    return Endurance(count, took, held[-1], growth(at, held))
