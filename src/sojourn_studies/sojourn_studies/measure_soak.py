"""Measures whether a stack that drives all day grows in memory or loses anything.

    scripts/lib/python -m sojourn_studies.measure_soak                 # 24 h of simulation as processes, half an hour
    scripts/lib/python -m sojourn_studies.measure_soak --hours 2 --composed

The rover drives two metres each half hour, to and fro, and waits in between, while the clock leaps. Told are what each
process holds in memory at first and at last, by how much that has grown once all buffers were full, and the verdict.
"""

import argparse
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.summary import summarise
from sojourn_bags.summary_reading import read_for_summary
from sojourn_config import command_line
from sojourn_studies.memory_growth import Sample, growth, told
from sojourn_studies.probed_stack import SUPPLIED, ProbedStack, add_options, bag_of, probed, to_and_fro

EVERY_S, WAIT_S, LEAP_S = 1800.0, 1700.0, 1200.0
"""From one drive to the next, of which it waits so long, and by how much the clock leaps then at most [s]."""
LOOK_S = 2.0
MOST_GROWTH = 0.01


def day(hours: float) -> list[str]:
    """What a run does for so long, as changes of its scenario."""
    drives = max(1, round(hours * 3600.0 / EVERY_S))
    return [*to_and_fro(drives, f"{{wait_s: {WAIT_S}}}"), f"leaps={{longest_s: {LEAP_S}}}"]


def soak(stack: ProbedStack) -> list[Sample]:
    """Memory of each process until the first of them ends: then the supervisor reads the bag, to judge it."""
    stack.wait_for(r": running")
    samples: list[Sample] = []
    while stack.runs:
        samples.append(stack.memory_mb())
        time.sleep(LOOK_S)
    return [sample for sample in samples if samples[0].keys() <= sample.keys()]


def measure(given: argparse.Namespace, run_dir: Path) -> bool:
    """Measure and print; whether nothing was lost, every goal was met, and no process has grown."""
    with probed(given, ["--composed" if given.composed else "--processes"], day(given.hours), run_dir) as stack:
        samples = soak(stack)
        status = stack.wait()
    for line in told(samples):
        print(line)
    summary = summarise(bag_of("soaked", run_dir, read_for_summary))
    print(f"status {status}: {summary['verdict']}")
    grown = [growth([sample[name] for sample in samples if name in sample]) for name in samples[0]]
    return status == 0 and bool(summary["all_met"]) and not any(part > MOST_GROWTH for part in grown)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a goal is not met, something is lost, or a process grows."""
    parser = command_line.Parser(prog="measure_soak", description="A day of driving: what it leaves in memory.")
    add_options(parser, SUPPLIED)
    parser.add_argument("--composed", action="store_true", help="all nodes in one process")
    parser.add_argument("--hours", type=command_line.positive, default=24.0, metavar="H", help="default: %(default)s")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="sojourn-soak-") as folder:
        return 0 if measure(given, Path(folder) / "run") else 1


if __name__ == "__main__":
    command_line.run_script(main)
