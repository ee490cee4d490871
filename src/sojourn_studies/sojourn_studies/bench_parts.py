"""The parts of the bench, measured one after another: the work of scripts/bench."""

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sojourn_bringup.run_folder import new_folder
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.paths import repository_root
from sojourn_studies import (
    bench_arm,
    bench_arm_limits,
    bench_cameras,
    bench_commands,
    bench_contacts,
    bench_ground,
    bench_loop,
    bench_machine,
    bench_network,
    bench_period,
    bench_start,
    bench_step,
    bench_wheel,
)
from sojourn_studies.bench import OF_A_SCENARIO, RESULT, SCENARIO

TARGETS = {
    **bench_step.TARGETS,
    **bench_start.TARGETS,
    bench_contacts.NOT_FINITE: ("<=", 0.0),
    **bench_loop.TARGETS,
    **bench_arm.TARGETS,
    **bench_arm_limits.TARGETS,
    **bench_wheel.TARGETS,
    **bench_commands.TARGETS,
    **bench_machine.TARGETS,
    **bench_network.TARGETS,
    **bench_cameras.TARGETS,
}


class Size(NamedTuple):
    """How much is measured.

    Args:
        cases: of the surveys of contact laws, and of the wheel on soil. maps: sizes of ground [m].
        poses: of each arm. plans, goals: of the arm's planning. distance: of the long drive [m].
        starts: of each command. seconds, rounds: simulated time of a run of the loop [s], and runs.
        commands: that are timed. periods: that are timed by app. turns: with each power network. readings: of each
            camera and lidar. views: seconds of each loop with a camera and without [s].
    """

    cases: int
    maps: tuple[int, ...]
    poses: int
    plans: int
    goals: int
    distance: float
    seconds: float
    rounds: int
    commands: int
    starts: int
    periods: int
    turns: int
    readings: int
    views: int


QUICK = Size(100_000, (10, 100), 1000, 50, 500, 3.0, 15.0, 1, 100, 2, 600, 190, 15, 15)
FULL = Size(1_000_000, (10, 100, 1000), 10_000, 200, 100_000, 100.0, 40.0, 3, 400, 7, 3000, 370, 60, 60)
Part = Callable[[Size, argparse.Namespace], dict[str, float]]
PARTS: dict[str, Part] = {
    "step": lambda size, given: bench_step.bench_step(given.scenario),
    "period": lambda size, given: bench_period.bench_period(given.scenario, size.periods, given.domain),
    "network": lambda size, given: bench_network.bench_network(size.turns),
    "start": lambda size, given: bench_start.bench_start(given.domain, size.starts, tell),
    "direct": lambda size, given: _loop("direct", size, given),
    "composed": lambda size, given: _loop("composed", size, given),
    "processes": lambda size, given: _loop("processes", size, given),
    "commands": lambda size, given: bench_commands.bench_commands(given.domain, size.commands),
    "wheel": lambda size, given: bench_wheel.bench_wheel(size.cases),
    "contacts": lambda size, given: bench_contacts.bench_contacts(size.cases),
    "ground": lambda size, given: bench_ground.bench_ground(size.maps),
    "arm": lambda size, given: (
        bench_arm.inverse_kinematics(size.poses) | bench_arm_limits.plan_through_points(size.plans)
    ),
    "arm_limits": lambda size, given: bench_arm_limits.random_goals(size.goals),
    "wheels": lambda size, given: bench_machine.bench_wheels(),
    "energy": lambda size, given: bench_machine.bench_energy(size.distance),
    "cameras": lambda size, given: bench_cameras.bench_cameras(size.readings, size.views),
}


def _loop(kind: str, size: Size, given: argparse.Namespace) -> dict[str, float]:
    return bench_loop.bench_loop(kind, given.scenario, size.seconds, size.rounds, tell)


def tell(text: str) -> None:
    """A line of progress."""
    print(f"bench: {text}", file=sys.stderr, flush=True)


def _table(figures: dict[str, float], targets: Mapping[str, tuple[str, float]]) -> Table:
    table = Table("figure", "measured", "to reach", title="Bench")
    for name, value in figures.items():
        sign, target = targets.get(name, ("", 0.0))
        met = not sign or (value <= target if sign == "<=" else value >= target)
        table.add_row(escape(name), f"{value:.2f}", f"{sign} {target:g}" if sign else "", style=None if met else "red")
    return table


def place_of(wanted: Path | None) -> Path:
    """File for the figures: a new one, never one that is there. Raises UsageError."""
    if wanted is None:
        return new_folder(repository_root() / "runs") / RESULT
    if wanted.exists():
        raise UsageError(f"--json {wanted} is there already: name a new file, or remove it first")
    if not wanted.absolute().parent.is_dir():
        raise UsageError(f"--json {wanted}: there is no folder {wanted.absolute().parent}")
    return wanted


def measure(
    names: Sequence[str], size: Size, given: argparse.Namespace, place: Path
) -> tuple[dict[str, float], list[str]]:
    """Figures of these parts, and the parts that could not be measured; the file has every part that is through."""
    figures: dict[str, float] = {}
    failed = []
    for number, name in enumerate(names):
        tell(f"{name}, part {number + 1} of {len(names)} ...")
        begin = time.monotonic()
        try:
            figures |= PARTS[name](size, given)
        except CommandError as error:
            tell(f"{name} could not be measured: {error}")
            failed.append(name)
            continue
        place.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
        tell(f"{name} took {time.monotonic() - begin:.0f} s")
    return figures, failed


def run(given: argparse.Namespace) -> int:
    """Measure, print a table, write JSON."""
    if given.child:
        given.began = float(given.began)
        return bench_loop.child(given)
    parts = tuple(given.only or (PARTS if given.scenario is None else OF_A_SCENARIO))
    if given.scenario is not None and (other := [name for name in parts if name not in OF_A_SCENARIO]):
        allowed = ", ".join(OF_A_SCENARIO)
        raise UsageError(f"--scenario does not go with --only {other[0]}, which has its own scene; allowed: {allowed}")
    targets = TARGETS if given.scenario in (None, SCENARIO) else {}
    given.scenario = given.scenario or SCENARIO
    chosen = {name: value for name in ("seconds", "rounds") if (value := getattr(given, name)) is not None}
    place = place_of(given.json)
    size = (FULL if given.full else QUICK)._replace(**chosen)
    figures, failed = measure(parts, size, given, place)
    Console().print(_table(figures, targets))
    tell(f"the figures are in {place}")
    return 1 if failed else 0
