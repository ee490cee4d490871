"""A running stack, as a user starts it, to which somebody does something: its processes, its words, its record."""

import argparse
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self

import psutil

from sojourn_bags.errors import BagsError
from sojourn_bags.reading import Bag, read_bag
from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.interruption import ended_by_signals
from sojourn_config.ros_environment import own_environment, ros_variables

START_S, SILENCE_S = 600, 120
"""Wall time within which it has to run, and after which it ends where a node is silent [s]: a machine may be busy."""
END_S = 120.0
"""Wall time that it has to end after SIGINT; its recorder finishes the bag within that."""
WAITING = ("steps=[{wait_s: 1e6}]", "duration_limit_s=1e6")
"""Changes of a scenario whose operator does nothing: all that happens to its run comes from elsewhere."""
LOOK_S = 0.005
NODE = re.compile(r"^(\w+) \(process (\d+)\): ", re.MULTILINE)
"""What a stack says of a node begins so."""
ENDED = re.compile(r" after ([0-9.]+) s of simulation, ([0-9.]+) s of wall time$", re.MULTILINE)
"""Its last words: how much it has simulated, and how long that took."""
TITLE = "sojourn_"
"""Beginning of what nodes call themselves, before their role."""


class ProbedStack:
    """A stack in processes of its own. A context manager: it is ended with it.

    Args:
        options: of scripts/start.py, the scenario among them. domain: of ROS. run_dir: new folder of the run.

    Attributes:
        run_dir: as given.
    """

    def __init__(self, options: Sequence[str], domain: int, run_dir: Path) -> None:
        self._command = [sys.executable, "-m", "sojourn_bringup.start", *options]
        self._command += ["--domain", str(domain), "--run-dir", str(run_dir)]
        self._command += ["--start-timeout", str(START_S), "--lockstep-timeout", str(SILENCE_S)]
        self._domain, self.run_dir = domain, run_dir
        self._log = run_dir.with_suffix(".log")
        self._signals = ExitStack()

    def __enter__(self) -> Self:
        environment = own_environment(os.environ, ros_variables(self._domain))
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                self._command, stdout=log, stderr=subprocess.STDOUT, env=environment, start_new_session=True
            )
        self._signals.enter_context(ended_by_signals())
        return self

    def __exit__(self, *_error: object) -> None:
        with self._signals:
            self.end()

    def end(self) -> int:
        """Interrupt it where it still runs, and wait. Its exit status."""
        if self.runs:
            self._process.send_signal(signal.SIGINT)
        return self.wait()

    def wait(self) -> int:
        """Until it ends by itself; kill it where it does not. Its exit status."""
        try:
            return self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            return self._process.wait()

    @property
    def words(self) -> str:
        """What it has said so far."""
        return self._log.read_text(encoding="utf-8", errors="replace")

    @property
    def runs(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def require_running(self) -> None:
        """Raises CommandError with its last line where it has ended."""
        if not self.runs:
            said = self.words.strip().splitlines()
            raise CommandError(f"the stack has ended: {said[-1] if said else 'it said nothing'}")

    def wait_for(self, pattern: str, longest_s: float = START_S) -> re.Match[str]:
        """Until it has said a pattern of one line. Raises CommandError where it has ended without, or not said it."""
        end = time.monotonic() + longest_s
        while not (found := re.search(pattern, self.words, re.MULTILINE)):
            if not self.runs and not re.search(pattern, self.words, re.MULTILINE):
                self.require_running()
            if time.monotonic() > end:
                raise CommandError(f"the stack has not said {pattern!r} within {longest_s:g} s")
            time.sleep(LOOK_S)
        return found

    @property
    def nodes(self) -> dict[str, int]:
        """Number of the process in which each role is now, as the stack has said it last."""
        return {role: int(number) for role, number in NODE.findall(self.words)}

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


def add_options(parser: argparse.ArgumentParser, scenario: str = "flat_drive") -> None:
    """Of what is run, and how. scenario: by default."""
    command_line.add_scenario(parser, scenario, "that is run")
    parser.add_argument("--realtime", action="store_true", help="paced by the wall clock, not in lock-step")
    parser.add_argument("--domain", type=command_line.domain, default=77, metavar="N", help="default: %(default)s")


def probed(given: argparse.Namespace, layout: Sequence[str], changes: Sequence[str], run_dir: Path) -> ProbedStack:
    """The stack of `add_options`.

    Args:
        layout: options of scripts/start.py. changes: of the scenario, under those that are given.
    """
    options = [given.scenario, *layout, *(["--realtime"] if given.realtime else [])]
    for change in (*changes, *command_line.changes_of(given)):
        options += ["--set", change]
    return ProbedStack(options, given.domain, run_dir)


def bag_of(run: str, path: Path, read: Callable[[Path], Bag] = read_bag) -> Bag:
    """The bag at a path. run: what was done to it, in a word. Raises CommandError where it cannot be read."""
    try:
        return read(path)
    except BagsError as error:
        raise CommandError(f"the bag of the {run} run: {error}") from error


def _name(process: psutil.Process) -> str:
    """What it calls itself: a role, or that which starts the others."""
    try:
        words = process.cmdline()
    except psutil.Error:
        words = []
    return words[0].removeprefix(TITLE) if words and words[0].startswith(TITLE) else "start"
