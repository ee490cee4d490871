"""Which lines of apps and flight laws a piece of work goes through: what a set of replays says anything about.

Only statements inside functions count, for all others run when a module is imported. Kernels count where the process
was started with NUMBA_DISABLE_JIT=1, so that they run as Python; else files of kernels cannot be told and are left
out, as the shells of nodes always are. The measurement is coverage.py's (Batchelder), in the process itself.
"""

import ast
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import coverage
import numba

import sojourn_flight
from sojourn_stack.apps import APPS

_FLIGHT = Path(sojourn_flight.__file__).parent
_LAWS = {
    "drive": ("mobility", "odometry", "planning", "hazards", "supervision"),
    "arm": ("arm",),
    "power": ("power_manager",),
}
FLIGHT_ROLES = tuple(_LAWS)
_SHELLS = ("node.py", "__main__.py", "setup.py")
_KERNELS = "kernels import "


def folders_of(role: str) -> tuple[Path, ...]:
    """Where a role's app is, and the flight laws that it goes by."""
    package = Path(str(sys.modules[APPS[role].__module__].__file__)).parent
    return (package, *(_FLIGHT / name for name in _LAWS.get(role, ())))


@dataclass(frozen=True)
class Exercise:
    """Of one file.

    Args:
        path: of the file. lines: statements in its functions, by their first line. run: those that were run.
        refusals: those that raise an error.
    """

    path: Path
    lines: frozenset[int]
    run: frozenset[int]
    refusals: frozenset[int]

    @property
    def missed(self) -> list[int]:
        """Lines that were not run."""
        return sorted(self.lines - self.run)

    def joined(self, other: "Exercise") -> "Exercise":
        """Of two pieces of work on the same file."""
        return Exercise(self.path, self.lines, self.run | other.run, self.refusals)


def exercised(work: Callable[[], object], folders: Sequence[Path]) -> dict[Path, Exercise]:
    """Do a piece of work and see what of the Python files in these folders it goes through."""
    measured = coverage.Coverage(data_file=None, config_file=False, source=[str(folder) for folder in folders])
    measured.start()
    try:
        work()
    finally:
        measured.stop()
    compiled = not numba.config.DISABLE_JIT
    found = {}
    for folder in folders:
        for path in sorted(folder.rglob("*.py")):
            if path.name in _SHELLS or (compiled and _KERNELS in path.read_text(encoding="utf-8")):
                continue
            statements, refusals = _in_functions(path)
            _, known, _, missing, _ = measured.analysis2(str(path))
            lines = statements.intersection(known)
            if lines:
                found[path] = Exercise(path, frozenset(lines), frozenset(lines.difference(missing)), refusals & lines)
    return found


def joined(one: Mapping[Path, Exercise], other: Mapping[Path, Exercise]) -> dict[Path, Exercise]:
    """Of two pieces of work."""
    both = {path: found.joined(other[path]) for path, found in one.items() if path in other}
    return {**one, **other, **both}


def share(found: Sequence[Exercise]) -> float:
    """Part of the lines that was run [-]; 1 where there is none."""
    lines = sum(len(each.lines) for each in found)
    return sum(len(each.run) for each in found) / lines if lines else 1.0


def _in_functions(path: Path) -> tuple[frozenset[int], frozenset[int]]:
    """First lines of the statements inside functions, and of those that raise."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    statements, refusals = set(), set()
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        for node in _below(function.body):
            statements.add(node.lineno)
            if isinstance(node, ast.Raise):
                refusals.add(node.lineno)
    return frozenset(statements), frozenset(refusals)


def _below(body: Sequence[ast.stmt]) -> Iterator[ast.stmt]:
    for statement in body:
        yield from (node for node in ast.walk(statement) if isinstance(node, ast.stmt))
