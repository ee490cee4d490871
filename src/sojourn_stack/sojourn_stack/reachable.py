"""Which functions of our source files an app can come to at all: what a set of bags could go through.

Two rules, read off the files and not off any run. A module counts if the app imports it, itself or through others, or
an entry point of ours names it. Of these modules a function counts if a live place names it: a statement that runs on
import, or a function that counts. A name stands for all functions and methods that have it, so what counts is rather
too much than too little; methods that Python calls by itself, and checks of values, count where their class is named.
"""

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

OURS = "sojourn_"
_CHECKS = ("validator", "serializer")
_Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass
class _Place:
    """A function, or all of a module or class that runs when it is read.

    Args:
        path, line: where its definition begins. keys: names any of which makes it live.
    """

    path: Path
    line: int
    keys: tuple[str, ...]
    names: set[str] = field(default_factory=set)
    """That it uses."""


def reachable(modules: Iterable[str], names: Iterable[str]) -> dict[Path, frozenset[int]]:
    """First lines of the functions that can be come to, by file.

    Args:
        modules: to begin with, in full. names: used from outside.
    """
    by_name: dict[str, list[_Place]] = defaultdict(list)
    found: dict[Path, set[int]] = defaultdict(set)
    entries = dict(_entries())
    waiting = {*names, *entries.values()}
    for module in _imported({*modules, *entries}):
        for place in _places(module):
            if not place.keys:
                waiting |= place.names
            for key in place.keys:
                by_name[key].append(place)
    seen: set[str] = set()
    while waiting:
        name = waiting.pop()
        seen.add(name)
        for place in by_name.get(name, ()):
            found[place.path].add(place.line)
            waiting |= place.names - seen
    return {path: frozenset(lines) for path, lines in found.items()}


def _entries() -> Iterator[tuple[str, str]]:
    """Module and name of what our registries find."""
    for group in entry_points().groups:
        for entry in entry_points(group=group) if group.startswith("sojourn.") else ():
            if entry.module.startswith(OURS):
                yield entry.module, entry.attr


def _imported(modules: Iterable[str]) -> set[str]:
    """These, and all of ours that they import."""
    waiting, found = set(modules), set()
    while waiting:
        module = waiting.pop()
        if _file(module) is not None:
            found.add(module)
            waiting |= _imports(module) - found
    return found


@cache
def _file(module: str) -> Path | None:
    """Its source, None where there is no such module of ours."""
    if not module.startswith(OURS):
        return None
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        return None
    return Path(spec.origin) if spec is not None and spec.origin is not None else None


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _imports(module: str) -> set[str]:
    """Of ours, but those for the checker of types alone; of a name that is imported its module, and it itself, for it
    may be one.
    """
    found = set()
    for node in _executed(_tree(_path(module))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return {name for name in found if name.startswith(OURS)}


def _path(module: str) -> Path:
    path = _file(module)
    if path is None:
        raise ModuleNotFoundError(module)
    return path


def _executed(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all in it but what stands under TYPE_CHECKING."""
    yield node
    if isinstance(node, ast.If) and "TYPE_CHECKING" in _named(node.test):
        return
    for child in ast.iter_child_nodes(node):
        yield from _executed(child)


def _places(module: str) -> Iterator[_Place]:
    path = _path(module)
    top = _Place(path, 0, ())
    yield from _within(_tree(path).body, top, "")
    yield top


def _within(body: Iterable[ast.stmt], around: _Place, owner: str) -> Iterator[_Place]:
    """Functions of a body; what else stands there is of the place around it."""
    for node in body:
        if isinstance(node, _Function):
            around.names |= {name for decorator in node.decorator_list for name in _named(decorator)}
            keys = (node.name, owner) if owner and _by_itself(node) else (node.name,)
            yield _Place(around.path, node.lineno, keys, _names_of_all(node.body) | _named(node.args))
        elif isinstance(node, ast.ClassDef):
            bases = {name for base in (*node.bases, *node.decorator_list) for name in _named(base)}
            inside = _Place(around.path, node.lineno, (node.name,), bases)
            yield from _within(node.body, inside, node.name)
            yield inside
        elif not isinstance(node, ast.Import | ast.ImportFrom):
            around.names |= _named(node)


def _by_itself(node: _Function) -> bool:
    """Whether nobody has to name it: Python does, or pydantic."""
    dunder = node.name.startswith("__") and node.name.endswith("__")
    decorators = {name for decorator in node.decorator_list for name in _named(decorator)}
    return dunder or any(name.endswith(_CHECKS) for name in decorators)


def _names_of_all(body: Iterable[ast.stmt]) -> set[str]:
    return {name for node in body for name in _named(node)}


def _named(node: ast.AST) -> set[str]:
    """Names that it reads, as names or as attributes."""
    found = set()
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            found.add(each.id)
        elif isinstance(each, ast.Attribute):
            found.add(each.attr)
    return found
