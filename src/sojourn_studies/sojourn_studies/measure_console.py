"""Measures by how much an open page slows a stack.

    scripts/lib/python -m sojourn_studies.measure_console              # the page opened and closed eight times
    scripts/lib/python -m sojourn_studies.measure_console --scenario mars_sol --processes --times 3

The page is opened and closed beside one run in lock-step, in which the rover drives to and fro: a machine that grows
slower or faster within minutes tells for neither, since each time with the page is set against those before and after
it. The page is read by one who draws nothing, as a browser reads it whose pictures a graphics card makes. Told are
seconds of simulation in a second of wall time, and the mean part by which the run is slower with the page, with the
standard deviation of that mean.
"""

import argparse
import math
import re
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import viser
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_studies.bag_clock import BagClock
from sojourn_studies.probed_program import ProbedProgram
from sojourn_studies.probed_stack import SUPPLIED, ProbedStack, add_options, probed, to_and_fro

ADDRESS = re.compile(r"http://(127\.0\.0\.1:\d+/[\w-]+/)")
MOST_SLOWER = 0.05
SETTLES_S, WINDOW_S = 6.0, 12.0
"""Wall time before a pace is taken, and over which it is taken [s]."""
SHOWS_S = 1.0
"""Within which a page shows something new where the rover drives."""
DRIVES = 1000
"""More than a run of that length has."""


@contextmanager
def reader(address: str) -> Iterator[list[int]]:
    """One who reads a page until the end. address: HOST:PORT/TOKEN/. Yields the number of bytes read so far."""
    read, ends = [0], threading.Event()

    def run() -> None:
        protocol = [f"viser-v{viser.__version__}"]
        with connect(f"ws://{address}", subprotocols=protocol, max_size=None) as page:  # type: ignore[arg-type]
            while not ends.is_set():
                try:
                    read[0] += len(page.recv(timeout=0.2))
                except TimeoutError:
                    continue
                except WebSocketException:
                    return

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield read
    finally:
        ends.set()
        thread.join()


@contextmanager
def page(stack: ProbedStack, log: Path) -> Iterator[list[int]]:
    """The page of a running stack and one who reads it. log: for what it says. Yields as `reader` does."""
    options = ["--run-dir", str(stack.run_dir)]
    with (
        ProbedProgram("sojourn_console.console", options, stack.domain, log) as program,
        reader(program.wait_for(ADDRESS.pattern)[1]) as read,
    ):
        yield read


def pace(clock: BagClock) -> float:
    """Seconds of simulation in one of wall time, over a while and after a while."""
    time.sleep(SETTLES_S)
    begin = clock.read()
    time.sleep(WINDOW_S)
    return begin.pace(clock.read())


def paced(given: argparse.Namespace, folder: Path) -> Iterator[tuple[float, float, float]]:
    """Pace before, with and after each time that the page is open."""
    layout = ["--processes" if given.processes else "--composed"]
    with probed(given, layout, to_and_fro(DRIVES), folder / "run") as stack:
        stack.wait_for(r": running")
        clock = BagClock(stack.run_dir)
        before = pace(clock)
        for number in range(given.times):
            with page(stack, folder / f"page-{number}.log") as read:
                opened, seen = pace(clock), read[0]
                time.sleep(SHOWS_S)
                if read[0] == seen:
                    raise CommandError("the page shows nothing, or nobody reads it any more")
            after = pace(clock)
            yield before, opened, after
            before = after


def measure(given: argparse.Namespace, folder: Path) -> bool:
    """Measure and print; whether the page slows the stack by no more than it may."""
    slower = []
    for before, opened, after in paced(given, folder):
        slower.append(0.5 * (before + after) / opened - 1.0)
        print(f"{before:.2f} before, {opened:.2f} with the page, {after:.2f} after it: {100.0 * slower[-1]:+.1f} %")
    mean, deviation = float(np.mean(slower)), float(np.std(slower)) / math.sqrt(max(1, len(slower) - 1))
    print(f"slower by {100.0 * mean:+.1f} % in the mean of {len(slower)}, standard deviation {100.0 * deviation:.1f} %")
    return mean <= MOST_SLOWER


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where the page slows the stack by more than it may."""
    parser = command_line.Parser(prog="measure_console", description="By how much an open page slows a stack.")
    add_options(parser, SUPPLIED)
    parser.add_argument("--processes", action="store_true", help="each node in a process of its own")
    parser.add_argument(
        "--times", type=command_line.count, default=8, metavar="N", help="the page is opened (default: %(default)s)"
    )
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="sojourn-console-") as folder:
        return 0 if measure(given, Path(folder)) else 1


if __name__ == "__main__":
    command_line.run_script(main)
