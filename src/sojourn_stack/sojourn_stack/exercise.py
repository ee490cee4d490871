"""Which lines of apps and flight laws a piece of work goes through: what a set of replays says anything about.

Only statements inside functions count, for all others run when a module is imported; of apps and flight laws only
functions that the apps can come to (`reachable`): what stands beside them for the tools of analysis is none of a
replay's business, and neither is a body that only says that it is not implemented. Kernels count where the process was
started with NUMBA_DISABLE_JIT=1, so that they run as Python; else files of kernels cannot be told and are left out, as
the shells of nodes always are. The measurement is coverage.py's (Batchelder), in the process itself.
"""

import ast
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import coverage
import numba

import sojourn_flight
from sojourn_contract.app import App
from sojourn_stack.apps import APPS
from sojourn_stack.reachable import reachable

_FLIGHT = Path(sojourn_flight.__file__).parent
_LAWS = {
    "drive": ("mobility", "odometry", "planning", "hazards", "supervision"),
    "arm": ("arm",),
    "power": ("power_manager",),
}
FLIGHT_ROLES = tuple(_LAWS)
_SHELLS = ("node.py", "__main__.py", "setup.py")
_KERNELS = "kernels import "
_LOADING = "load_scenario"
"""By which a node reads what its app is made of."""


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


def exercised(
    work: Callable[[], object], folders: Sequence[Path], counted: Mapping[Path, frozenset[int]] | None = None
) -> dict[Path, Exercise]:
    """Do a piece of work and see what of the Python files in these folders it goes through.

    Args:
        counted: first lines of the functions that count, by file; None: all do.
    """
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
            statements, refusals = _in_functions(path, None if counted is None else counted.get(path, frozenset()))
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


@cache
def functions_of_apps() -> Mapping[Path, frozenset[int]]:
    """Functions that the apps can come to, by file: their first lines."""
    interface = {name for name in vars(App) if not name.startswith("_")}
    modules = [kind.__module__ for kind in APPS.values()]
    return reachable(modules, interface | {kind.__name__ for kind in APPS.values()} | {_LOADING})


def _in_functions(path: Path, counted: Collection[int] | None) -> tuple[frozenset[int], frozenset[int]]:
    """First lines of the statements inside functions that count, and of those that raise."""
    functions = (node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.FunctionDef))
    statements, refusals = set(), set()
    for function in (node for node in functions if counted is None or node.lineno in counted):
        if _is_abstract(function):
            continue
        for node in _below(function.body):
            statements.add(node.lineno)
            if isinstance(node, ast.Raise):
                refusals.add(node.lineno)
    return frozenset(statements), frozenset(refusals)


def _is_abstract(function: ast.FunctionDef) -> bool:
    """Whether it only says what those that stand for it are to do: a docstring, and that it is not implemented."""
    last = function.body[-1]
    if not isinstance(last, ast.Raise) or any(not isinstance(node, ast.Expr) for node in function.body[:-1]):
        return False
    return isinstance(last.exc, ast.Name) and last.exc.id == NotImplementedError.__name__


def _below(body: Sequence[ast.stmt]) -> Iterator[ast.stmt]:
    for statement in body:
        yield from (node for node in ast.walk(statement) if isinstance(node, ast.stmt))
