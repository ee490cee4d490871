"""Measures what becomes of a running stack whose nodes are killed, each at many moments.

    scripts/lib/python -m sojourn_studies.measure_kills --kills 20              # lock-step, driving: each ends a run
    scripts/lib/python -m sojourn_studies.measure_kills --kills 20 --realtime   # killed nodes are started again

Told of each kill: how soon the stack has noticed it, how soon the node runs again or what the run ended with, and how
much of the run the bags lack. In real time all nodes but the plant are killed in turn in one run; the plant, with which
the world is gone, ends one each time.
"""

import argparse
import os
import re
import signal
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sojourn_bringup.process_table import ROLE_NAMES, process
from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_contract.stamps import seconds
from sojourn_studies.probed_stack import ENDED, WAITING, ProbedStack, add_options, bag_of, probed

SQUARE = "[{x: 5.0, y: 0.0}, {x: 5.0, y: 6.0}, {x: -5.0, y: 6.0}, {x: -5.0, y: -5.0}, {x: 5.0, y: -5.0}]"
DRIVES = (f"steps=[{{drive_route: {{points: {SQUARE}}}, timeout_s: 1e5}}]", "duration_limit_s=1e5")
"""What the run does meanwhile in lock-step. In real time it waits: a goal is lost with the drive, and a run with
its goal.
"""
SOONEST_S, LATEST_S = 0.5, 5.0
"""Wall time from the loop's first periods, or from when the last killed node ran again, to a kill."""
SPARED_S = 11.0
"""Wall time between two kills of one role: who dies more than three times in half a minute is not started again."""
NOTICED_S, LOST_S = 1.0, 1.0
"""That a kill may take to be noticed, and that the bags may lack [s of wall time]."""


class Kill(NamedTuple):
    """Role, wall time until it was noticed [s], wall time until the node ran again, None where it did not [s], and the
    run's last words about it.
    """

    role: str
    noticed_s: float
    back_s: float | None
    words: str


def kill(stack: ProbedStack, role: str) -> Kill:
    """A node of it, which is noticed. Raises CommandError where it is not."""
    victim, begun = stack.nodes[role], time.monotonic()
    os.kill(victim, signal.SIGKILL)
    line = stack.wait_for(rf"^.*{role} \(process {victim}\) was killed by SIGKILL.*$")
    noticed = time.monotonic() - begun
    again = re.search(r"started again as process (\d+)", line[0])
    if again is None:
        return Kill(role, noticed, None, line[0])
    stack.wait_for(rf"^{role} \(process {again[1]}\): running")
    return Kill(role, noticed, time.monotonic() - begun, line[0])


def held(bag: Path) -> tuple[float, float] | None:
    """Simulation times from which and up to which a bag goes [s]; None of one that holds nothing.

    Raises CommandError where it cannot be read.
    """
    times = [at for messages in bag_of("killed", bag).topics.values() for at in messages.log_times]
    return (seconds(min(times)), seconds(max(times))) if times else None


def lacking_s(stack: ProbedStack) -> float:
    """Longest wall time that the bags of a run that has ended lack, between two of them or at the end [s].

    Raises CommandError where one cannot be read.
    """
    *_, (simulated, wall) = [(float(at), float(wall)) for at, wall in ENDED.findall(stack.words)]
    lacking, before = 0.0, 0.0
    for first, last in sorted(filter(None, map(held, stack.run_dir.glob("bag*")))):
        lacking, before = max(lacking, first - before), last
    return max(lacking, simulated - before) * wall / max(simulated, 1e-9)


def one_run(
    given: argparse.Namespace, roles: Iterable[str], random: np.random.Generator, run_dir: Path
) -> tuple[list[Kill], float]:
    """Kills of one run, the roles in turn, and what its bags lack [s]; prints them. Raises CommandError."""
    kills, last = list[Kill](), dict[str, float]()
    with probed(given, ["--processes"], WAITING if given.realtime else DRIVES, run_dir) as stack:
        for role in ROLE_NAMES:
            stack.wait_for(rf"^{role} \(process \d+\): running")
        for role in roles:
            spared = last.get(role, 0.0) + SPARED_S - time.monotonic()
            time.sleep(max(spared, random.uniform(SOONEST_S, LATEST_S)))
            kills.append(kill(stack, role))
            last[role] = time.monotonic()
            if kills[-1].back_s is None:
                break
        if kills[-1].back_s is None and (status := stack.wait()) != 1:
            raise CommandError(f"a run that has lost its {kills[-1].role} ended with status {status}")
    for one in kills:
        print(in_words(one), flush=True)
    lacking = lacking_s(stack)
    print(f"  the bags lack {lacking:.2f} s", flush=True)
    if lacking > LOST_S:
        print(f"  that is more than {LOST_S:g} s")
    return kills, lacking


def in_words(one: Kill) -> str:
    """A kill, in a line."""
    what = one.words if one.back_s is None else f"runs again after {one.back_s:.2f} s"
    return f"{one.role}: noticed after {one.noticed_s:.2f} s, {what}"


def runs(given: argparse.Namespace) -> Iterator[list[str]]:
    """The roles that are killed in each run."""
    roles = [role for role in ROLE_NAMES if given.role in (None, role)]
    restarted = [role for role in roles if given.realtime and process(role).restartable]
    if restarted:
        yield restarted * given.kills
    for role in roles:
        if role not in restarted:
            yield from [[role]] * given.kills


def spread(times: Sequence[float]) -> str:
    """Of times [s], in words."""
    return f"{np.median(times):.2f} s, {max(times):.2f} s at most"


def told(kills: Sequence[Kill], lacking: float) -> bool:
    """Print what all of them come to; whether each was noticed in time, and no bags lack more [s] than they may."""
    for role in dict.fromkeys(one.role for one in kills):
        noticed = [one.noticed_s for one in kills if one.role == role]
        back = [one.back_s for one in kills if one.role == role and one.back_s is not None]
        again = f", again after {spread(back)}" if back else ""
        print(f"{role}: {len(noticed)} kills, noticed after {spread(noticed)}{again}")
    return lacking <= LOST_S and all(one.noticed_s <= NOTICED_S for one in kills)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a kill was noticed late, or bags lack more than they may."""
    parser = command_line.Parser(prog="measure_kills", description="What becomes of a stack whose nodes are killed.")
    add_options(parser)
    parser.add_argument("--role", choices=ROLE_NAMES, help="that is killed (default: each)")
    parser.add_argument("--kills", type=command_line.count, default=3, metavar="N", help="of each role (default: 3)")
    parser.add_argument("--seed", type=command_line.whole_number, default=1, metavar="N", help="of the moments")
    given = parser.parse_args(arguments)
    random, kills, most = np.random.default_rng(given.seed), list[Kill](), 0.0
    with tempfile.TemporaryDirectory(prefix="sojourn-kills-") as folder:
        for number, roles in enumerate(runs(given)):
            of_run, lacking = one_run(given, roles, random, Path(folder) / str(number))
            kills, most = kills + of_run, max(most, lacking)
    return 0 if told(kills, most) else 1


if __name__ == "__main__":
    command_line.run_script(main)
