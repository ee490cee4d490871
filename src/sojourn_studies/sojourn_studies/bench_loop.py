"""Bench of the whole loop, recorder running: speed, start-up and memory, direct, composed and as processes."""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from sojourn_bringup import start, start_run
from sojourn_bringup.process_state import memory_mb
from sojourn_bringup.screen import Screen
from sojourn_config.command_errors import CommandError
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_studies.bench_step import Yardstick

KINDS = ("direct", "composed", "processes")
TARGETS = {
    "direct, period of the loop [Y]": ("<=", 180.0),
    "composed, period of the loop [Y]": ("<=", 240.0),
    "processes, period of the loop [Y]": ("<=", 300.0),
}


def bench_loop(kind: str, scenario: str, seconds: float, rounds: int, tell: Callable[[str], None]) -> dict[str, float]:
    """Medians over rounds; each is held against a Y that is measured just before and just after it.

    Args:
        kind: one of KINDS. scenario: that is run. seconds: simulated time of a round [s].
        tell: takes a line of progress.
    """
    yardstick, runs = Yardstick(), []
    for number in range(rounds):
        before = yardstick.microseconds()
        run = run_loop(kind, scenario, seconds)
        unit = 0.5 * (before + yardstick.microseconds())
        speed = run[f"{kind}, times real time"]
        run[f"{kind}, Y of that time [us]"] = unit
        run[f"{kind}, period of the loop [Y]"] = CONTROL_PERIOD_S / speed * 1e6 / unit
        runs.append(run)
        tell(f"{kind}, run {number + 1} of {rounds}: {speed:.1f} times real time")
    return {name: statistics.median(run[name] for run in runs) for name in runs[0]}


def run_loop(kind: str, scenario: str, seconds: float) -> dict[str, float]:
    """Speed, start-up and memory of one run, in a process of its own. Raises CommandError if it fails."""
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        command = [sys.executable, "-m", "sojourn_studies.bench", "--child", kind, "--seconds", str(seconds)]
        command += ["--scenario", scenario, "--run-dir", str(Path(folder) / "run"), "--began", repr(time.monotonic())]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CommandError(f"the bench of {kind} failed: {done.stderr.strip() or done.stdout.strip()}")
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def child(given: argparse.Namespace) -> int:
    """One run of the loop, in a process that `run_loop` has started; prints its figures as JSON."""
    wishes = [given.scenario, "--run-dir", given.run_dir, "--domain", str(given.domain)]
    wishes += ["--set", f"duration_limit_s={given.seconds}"]
    screen = Screen(Console(file=open(os.devnull, "w")))  # noqa: SIM115 - for the life of the process
    plan = start_run.make_plan(start.parser().parse_args(wishes), screen)
    figures: dict[str, float] = {}
    if given.child == "processes":
        from sojourn_bringup.supervisor import Supervisor

        supervisor = Supervisor(plan, screen)
        outcome, began = supervisor.run(), supervisor.stopwatch.began_at
        for role, node in supervisor.nodes.items():
            figures[f"processes, memory of {role} [MB]"] = node.peak_memory_mb
    else:
        from sojourn_bringup.composed import ComposedRun
        from sojourn_bringup.direct import DirectRun

        run = DirectRun(plan, screen) if given.child == "direct" else ComposedRun(plan, screen)
        outcome, began = run.run(), run.stopwatch.began_at
        figures[f"{given.child}, memory [MB]"] = memory_mb()
    if not outcome.wall_time_s or outcome.sim_time_s < 0.9 * given.seconds:
        print(outcome.message, file=sys.stderr)
        return 1
    figures[f"{given.child}, times real time"] = outcome.sim_time_s / outcome.wall_time_s
    figures[f"{given.child}, start-up [s]"] = began - given.began
    print(json.dumps(figures))
    return 0
