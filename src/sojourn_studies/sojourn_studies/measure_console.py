"""Measures by how much an open page slows a stack.

    scripts/lib/python -m sojourn_studies.measure_console              # ten runs in turns, with the page and without
    scripts/lib/python -m sojourn_studies.measure_console mars_sol --processes --pairs 3

The page is read by one who draws nothing, as a browser reads it whose pictures a graphics card makes. Told are seconds
of simulation in a second of wall time in each pair of runs, and the median part by which the one with the page is
slower.
"""

import argparse
import re
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import viser
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from sojourn_config import command_line
from sojourn_studies.probed_stack import ENDED, START_S, ProbedStack, add_options, probed

ADDRESS = re.compile(r"http://(127\.0\.0\.1:\d+/[\w-]+/)")
MOST_SLOWER = 0.05
PART_S = 180.0
"""Of each run, in simulation [s]."""


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


def pace(stack: ProbedStack) -> float:
    """Seconds of simulation in one of wall time, of a run that ends by itself. Raises CommandError."""
    found = stack.wait_for(ENDED.pattern, START_S)
    return float(found[1]) / float(found[2])


def paced(given: argparse.Namespace, with_page: bool, run_dir: Path) -> tuple[float, int]:
    """Pace of one run, and how many bytes of its page were read."""
    layout = ["--processes" if given.processes else "--composed", *(["--console"] if with_page else [])]
    with probed(given, layout, (f"duration_limit_s={PART_S:g}",), run_dir) as stack:
        if not with_page:
            return pace(stack), 0
        address = stack.wait_for(ADDRESS.pattern)[1]
        with reader(address) as read:
            return pace(stack), read[0]


def measure(given: argparse.Namespace, folder: Path) -> bool:
    """Measure and print; whether the page slows the stack by no more than it may."""
    slower = []
    for number in range(given.pairs):
        first = number % 2 == 1  # in turns, so that a machine that grows slower tells for neither
        paces = {page: paced(given, page, folder / f"{number}-{page:d}") for page in (first, not first)}
        slower.append(paces[False][0] / paces[True][0] - 1.0)
        megabytes = paces[True][1] / 1e6
        print(
            f"{paces[False][0]:.2f} without, {paces[True][0]:.2f} with the page, of which {megabytes:.1f} MB were read"
        )
    median = float(np.median(slower))
    print(f"slower by {100.0 * median:+.1f} % in the median of {given.pairs} pairs")
    return median <= MOST_SLOWER


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where the page slows the stack by more than it may."""
    parser = command_line.Parser(prog="measure_console", description="By how much an open page slows a stack.")
    add_options(parser, "lunar_sample")
    parser.add_argument("--processes", action="store_true", help="each node in a process of its own")
    parser.add_argument(
        "--pairs", type=command_line.count, default=5, metavar="N", help="of runs (default: %(default)s)"
    )
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="sojourn-console-") as folder:
        return 0 if measure(given, Path(folder)) else 1


if __name__ == "__main__":
    command_line.run_script(main)
