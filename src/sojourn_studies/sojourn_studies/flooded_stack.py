"""A running stack that is to be flooded: its processes, what they hold, and whether it still tells the truth."""

import math
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Self

import psutil

from sojourn_bags.errors import UnreadableBagError
from sojourn_bags.reading import bag_file, read_bag
from sojourn_config.command_errors import CommandError
from sojourn_config.ros_environment import own_environment, ros_variables

START_S, SILENCE_S = 600, 120
"""Wall time within which it has to run, and after which it ends where a node is silent [s]: a machine may be busy."""
END_S = 120.0
"""Wall time that it has to end after SIGINT; its recorder finishes the bag within that."""
WAITING = "steps=[{wait_s: 1e6}]"
"""What its operator does: all else that happens comes from elsewhere."""


class FloodedStack:
    """A stack in processes of its own. A context manager: it is ended with it.

    Args:
        scenario: with `options` of scripts/start.py. domain: of ROS. run_dir: new folder of the run.
    """

    def __init__(self, scenario: str, options: Sequence[str], domain: int, run_dir: Path) -> None:
        self._command = [sys.executable, "-m", "sojourn_bringup.start", scenario, "--set", WAITING, *options]
        self._command += ["--set", "duration_limit_s=1e6", "--domain", str(domain), "--run-dir", str(run_dir)]
        self._command += ["--start-timeout", str(START_S), "--lockstep-timeout", str(SILENCE_S)]
        self._domain, self._run_dir = domain, run_dir

    def __enter__(self) -> Self:
        self._run_dir.parent.mkdir(parents=True, exist_ok=True)
        self._log = self._run_dir.with_suffix(".log").open("wb")
        environment = own_environment(os.environ, ros_variables(self._domain))
        self._process = subprocess.Popen(
            self._command, stdout=self._log, stderr=subprocess.STDOUT, env=environment, start_new_session=True
        )
        return self

    def __exit__(self, *_error: object) -> None:
        self.end()
        self._log.close()

    def end(self) -> None:
        """Interrupt it and wait; kill it where it does not end."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def require_running(self) -> None:
        """Raises CommandError with its last line where it has ended."""
        if self._process.poll() is not None:
            said = Path(self._log.name).read_text(encoding="utf-8", errors="replace").strip().splitlines()
            raise CommandError(f"the stack has ended: {said[-1] if said else 'it said nothing'}")

    def memory_mb(self) -> dict[str, float]:
        """Resident memory of each of its processes, by number and name [MB]; those that begin or end are left out."""
        found: dict[str, float] = {}
        try:
            stack = psutil.Process(self._process.pid)
            for one in (stack, *stack.children(recursive=True)):
                found[f"{one.pid} {_name(one)}"] = one.memory_info().rss / 1e6
        except psutil.NoSuchProcess:
            pass
        return found

    def record(self) -> tuple[float, int]:
        """Size of the bag [MB] and messages in it, after the end. Raises CommandError where it cannot be read."""
        try:
            bag = read_bag(self._run_dir)
            size = sum(file.stat().st_size for file in bag_file(self._run_dir).parent.iterdir())
        except UnreadableBagError as error:
            raise CommandError(f"the bag of the flooded run: {error}") from error
        return size / 1e6, sum(len(messages) for messages in bag.topics.values())


def _name(process: psutil.Process) -> str:
    """What it calls itself: a role, or the program."""
    words = process.cmdline() or [process.name()]
    return words[0].removeprefix("sojourn_") if words[0].startswith("sojourn_") else "start"


def growth(series: Sequence[float]) -> float:
    """By which part the last fifth of a series is above its second fifth, by their medians [-]."""
    fifth = len(series) // 5
    if fifth == 0:
        return math.nan
    early, late = sorted(series[fifth : 2 * fifth]), sorted(series[-fifth:])
    return late[len(late) // 2] / early[len(early) // 2] - 1.0
