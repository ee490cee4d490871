"""A running stack, as a user starts it, to which somebody does something: its processes, its words, its record."""

import argparse
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import psutil

from sojourn_bags.errors import BagsError
from sojourn_bags.reading import Bag, read_bag
from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_studies.probed_program import START_S, ProbedProgram

SILENCE_S = 120
"""Wall time after which it ends where a node is silent [s]: a machine may be busy."""
WAITING = ("steps=[{wait_s: 1e6}]", "duration_limit_s=1e6")
"""Changes of a scenario whose operator does nothing: all that happens to its run comes from elsewhere."""
SUPPLIED = "isotope_sol"
"""A scenario whose machine has power by day and by night, for some hours of driving without a pause."""
NODE = re.compile(r"^(\w+) \(process (\d+)\): ", re.MULTILINE)
"""What a stack says of a node begins so."""
ENDED = re.compile(r" after ([0-9.]+) s of simulation, ([0-9.]+) s of wall time$", re.MULTILINE)
"""Its last words: how much it has simulated, and how long that took."""
TITLE = "sojourn_"
"""Beginning of what nodes call themselves, before their role."""


class ProbedStack(ProbedProgram):
    """A stack in processes of its own. A context manager: it is ended with it.

    Args:
        options: of scripts/start.py, the scenario among them. domain: of ROS. run_dir: new folder of the run.

    Attributes:
        run_dir: as given.
    """

    name = "stack"

    def __init__(self, options: Sequence[str], domain: int, run_dir: Path) -> None:
        patience = ["--start-timeout", str(START_S), "--lockstep-timeout", str(SILENCE_S)]
        module, log = "sojourn_bringup.start", run_dir.with_suffix(".log")
        super().__init__(module, [*options, "--run-dir", str(run_dir), *patience], domain, log)
        self.run_dir = run_dir

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


def to_and_fro(drives: int, *between: str) -> list[str]:
    """Changes of a scenario that has its machine drive two metres, again and again. between: steps after each drive."""
    steps = []
    for number in range(drives):
        steps += [f"{{drive_to: {{x: {1.0 - 2.0 * (number % 2)}, y: 0.0}}, timeout_s: 300}}", *between]
    return [f"steps=[{', '.join(steps)}]", "duration_limit_s=1e6"]


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
