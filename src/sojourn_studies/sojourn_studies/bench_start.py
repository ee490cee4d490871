"""Bench of start-up: what a command costs before it does what it was asked for, and what a page costs.

Processor time, user and system, of a command with its children (getrusage(2)); the least of some runs, since whatever
else the machine does adds to it. Beside it stand an empty Python and the import of numpy in the same run, as units for
a machine of another speed. Of a direct run it is the wall time to the end of its first period.
"""

import argparse
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from sojourn_config.command_errors import CommandError
from sojourn_config.paths import repository_root
from sojourn_config.ros_environment import own_environment, ros_variables

SCENARIO = "flat_drive"
ROVER = "explorer"
LONG_S = 20.0
"""Simulated time of the run that is reported on."""
GOAL_WAIT_S = 60.0
"""Wall time within which a stack must act on a goal."""
EMPTY, NUMPY = "empty Python, CPU [s]", "import numpy, CPU [s]"
HELP = "longest --help, CPU [s]"
GOAL = "goal stop, CPU [s]"
FIRST_PERIOD_CPU, FIRST_PERIOD = "direct run to its first period, CPU [s]", "direct run to its first period, wall [s]"
PAGE, SHEET = "report --html, CPU [s]", "data sheet, CPU [s]"
TARGETS = {HELP: ("<=", 0.6), GOAL: ("<=", 0.8), FIRST_PERIOD: ("<=", 3.0), PAGE: ("<=", 1.85), SHEET: ("<=", 6.4)}

Tell = Callable[[str], None]


def commands() -> dict[str, Path]:
    """Scripts that run a command of ours, by name; not those that set up, lock versions or test."""
    folder = repository_root() / "scripts"
    launched = re.compile(r'lib/python"|"lib", "python"')
    return {
        path.name: path
        for path in sorted(folder.iterdir())
        if path.is_file() and launched.search(path.read_text(encoding="utf-8"))
    }


def processor_time(command: Sequence[str | Path], runs: int, environment: Mapping[str, str] | None = None) -> float:
    """Least processor time of a command with its children over some runs [s]. Raises CommandError if it fails."""
    least = float("inf")
    for _ in range(runs):
        before = _used()
        done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        least = min(least, _used() - before)
        if done.returncode:
            raise CommandError(f"{' '.join(map(str, command))}: {done.stderr.decode(errors='replace').strip()}")
    return least


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def bench_start(domain: int, runs: int, tell: Tell) -> dict[str, float]:
    """All of it. Raises CommandError if a command fails."""
    scripts = commands()
    figures = {
        EMPTY: processor_time([sys.executable, "-c", "pass"], 5 * runs),
        NUMPY: processor_time([sys.executable, "-c", "import numpy"], runs),
    }
    helps = {f"{name} --help, CPU [s]": processor_time([path, "--help"], runs) for name, path in scripts.items()}
    figures |= {HELP: max(helps.values())} | helps
    tell("help of every script is timed; a goal ...")
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as base:
        folder = Path(base)
        figures[GOAL] = _goal(scripts, domain, runs, folder)
        tell("a direct run ...")
        starts = [_first_period(folder / f"short_{number}") for number in range(runs)]
        figures[FIRST_PERIOD_CPU], figures[FIRST_PERIOD] = (min(values) for values in zip(*starts, strict=True))
        run, page = folder / "run", folder / "page.html"
        long: list[str | Path] = [
            scripts["start.py"],
            SCENARIO,
            "--direct",
            "--run-dir",
            run,
            "--set",
            f"duration_limit_s={LONG_S}",
        ]
        # its goal may not be met by then, and a report has something to tell all the same
        subprocess.run(long, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        tell("a report and a data sheet ...")
        figures[PAGE] = processor_time([scripts["report"], run, "--html", "--out", page], runs)
        figures[SHEET] = processor_time([scripts["rover_datasheet"], ROVER, "--out", page], runs)
    return figures


def _goal(scripts: Mapping[str, Path], domain: int, runs: int, folder: Path) -> float:
    """A goal sent to a stack that runs in real time."""
    wishes = ["--composed", "--realtime", "--domain", str(domain), "--run-dir", str(folder / "stack")]
    wishes += ["--set", "steps=[]", "--set", "duration_limit_s=3000"]
    stack = subprocess.Popen(
        [sys.executable, "-m", "sojourn_bringup.start", SCENARIO, *wishes],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=own_environment(os.environ, ros_variables(domain)),
    )
    stop: list[str | Path] = [scripts["goal"], "stop", "--domain", str(domain)]
    try:
        end = time.monotonic() + GOAL_WAIT_S
        while subprocess.run(stop, stdin=subprocess.DEVNULL, capture_output=True, check=False).returncode:
            if stack.poll() is not None or time.monotonic() > end:
                raise CommandError("the bench of start-up: the stack does not run")
        return processor_time(stop, runs)
    finally:
        stack.terminate()
        try:
            stack.wait(20.0)
        except subprocess.TimeoutExpired:
            stack.kill()
            stack.wait()


def _first_period(folder: Path) -> tuple[float, float]:
    """Processor time and wall time of a process to the end of the first period of a direct run with its bag [s]."""
    command = [sys.executable, "-m", "sojourn_studies.bench_start", str(folder)]
    began = time.monotonic()
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CommandError(f"the bench of start-up: {done.stderr.strip()}")
    used, ended = map(float, done.stdout.split()[-2:])
    return used, ended - began


def main(arguments: Sequence[str] | None = None) -> int:
    """A direct run of one period into a folder; prints what it took of a processor, and when it was over."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    given = parser.parse_args(arguments)
    # not above: a direct run, too, begins with the options alone
    from sojourn_bringup import start, start_run
    from sojourn_bringup.screen import Screen
    from sojourn_stack.run import RunSpec, run
    from sojourn_stack.stack import StackState

    plan = start_run.make_plan(start.parser().parse_args([SCENARIO, "--direct", "--run-dir", given.folder]), Screen())
    ended: list[float] = []

    def goes_on(state: StackState) -> bool:
        if state.period == 2:  # the first is over
            ended.extend((time.process_time(), time.monotonic()))
        return not ended

    run(RunSpec(plan.scenario, plan.participants, plan.overrides, plan.bag(), plan.loaded), goes_on)
    print(*ended)
    return 0


if __name__ == "__main__":
    sys.exit(main())
