"""Which part of the flight laws a set of bags goes through: the work of scripts/replay --coverage.

A bag says nothing of what it never does; where this table is low, a defect passes every replay.
"""

import argparse
import os
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from sojourn_bringup.bench_options import check_role
from sojourn_bringup.references import REFERENCES, THEMES, references_folder
from sojourn_config.command_errors import UsageError

if TYPE_CHECKING:
    from sojourn_stack.exercise import Exercise

UNCOMPILED = "NUMBA_DISABLE_JIT"
"""Where it is 1 before numba is imported, kernels run as Python, and what they go through can be seen."""


def run_coverage(given: argparse.Namespace) -> int:
    """Replay, measure and tell. Returns the exit status: 1 where a bag is not replayed as recorded."""
    if given.exec or given.role:
        raise UsageError("replay: --coverage is of our own nodes: --node ROLE, or of all that would fly")
    if given.node and check_role(given.node, "--node") in ("plant", "sensors"):
        os.environ.pop(UNCOMPILED, None)  # the physics would take hours
    else:
        os.environ.setdefault(UNCOMPILED, "1")
    from sojourn_stack.exercise import FLIGHT_ROLES, folders_of  # not above: after the variable

    roles = (given.node,) if given.node else FLIGHT_ROLES
    found, differs = measure(given.bag or reference_bags(), roles, with_starts=not given.bag)
    folders = [folder for role in roles for folder in folders_of(role)]
    print("\n".join(lines_of_table(found, folders)))
    if given.missed:
        print("\n".join(lines_of_missed(found)))
    for told in differs:
        print(told)
    return 1 if differs else 0


def reference_bags() -> list[Path]:
    """All that there are."""
    return [references_folder() / reference.name for reference in (*REFERENCES, *THEMES)]


def measure(
    bags: Sequence[Path], roles: Sequence[str], with_starts: bool = False
) -> tuple[list["Exercise"], list[str]]:
    """Replay bags through our apps of some roles.

    Args:
        with_starts: start them with each of the wrong values besides (`wrong_values`).

    Returns:
        What they go through, by file; and of which bags a role gave other answers, or which wrong values it took, in
        words. A role that did not take part, or whose topics the bag does not have, is passed over.

    Raises:
        UsageError: a bag cannot be replayed.
    """
    from sojourn_bags.compare_runs import read_runs
    from sojourn_bags.comparison_result import Verdict
    from sojourn_bags.thinning import roles_of
    from sojourn_bringup.replay_run import replay_directly
    from sojourn_bringup.wrong_values import not_refused
    from sojourn_stack.exercise import exercised, folders_of, functions_of_apps

    differs: list[str] = []

    def work() -> None:
        for bag in read_runs(bags):
            present = roles_of(bag)
            for role in roles:
                if role not in present:
                    continue
                comparison = replay_directly(bag, role).comparison
                if comparison.verdict is Verdict.DIFFERENT:
                    differs.append(f"{bag.path}: {role} answers otherwise than recorded: {comparison.divergence()}")
        differs.extend(not_refused(roles) if with_starts else ())

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of infinities, which compiled kernels pass over in silence
        found = exercised(work, [folder for role in roles for folder in folders_of(role)], functions_of_apps())
    return list(found.values()), differs


def lines_of_table(found: Sequence["Exercise"], folders: Sequence[Path]) -> Iterator[str]:
    """A row a folder: lines in functions, the part of them that was run, and refusals that were raised."""
    from sojourn_stack.exercise import share

    yield f"{'':32}{'lines':>7}{'run':>8}{'refusals':>14}"
    by_folder: dict[Path, list[Exercise]] = defaultdict(list)
    for each in found:
        by_folder[next(folder for folder in folders if folder in each.path.parents)].append(each)
    for name, files in [*((folder.name, by_folder[folder]) for folder in folders), ("all", list(found))]:
        raised = sum(len(each.refusals & each.run) for each in files)
        refusals = f"{raised} of {sum(len(each.refusals) for each in files)}"
        yield f"{name:32}{sum(len(each.lines) for each in files):>7}{share(files):>8.1%}{refusals:>14}"


def lines_of_missed(found: Iterable["Exercise"]) -> Iterator[str]:
    """A row a file with lines that none goes through, those with most first."""
    for each in sorted(found, key=lambda one: -len(one.missed)):
        if each.missed:
            yield f"{each.path.parent.name}/{each.path.name}: {_ranges(each.missed)}"


def _ranges(numbers: Sequence[int]) -> str:
    """3, 5-7 of 3, 5, 6, 7."""
    parts = []
    for _, group in groupby(enumerate(numbers), lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        parts.append(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}")
    return ", ".join(parts)
