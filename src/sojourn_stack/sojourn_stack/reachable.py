"""Which functions of our source files an app can come to at all: what a set of bags could go through.

Two rules, read off the files and not off any run. A module counts if the app imports it, itself or through others, or
an entry point of ours names it. Of these modules a function counts if a live place names it: a statement that runs on
import, or a function that counts. A name is what it is bound to by an import or in its own module; what stands behind a
dot is every method of that name in a class that counts, and every function of that name in a module that is imported as
a whole. So what counts is rather too much than too little. Methods that Python calls by itself, and checks of values,
count where their class does.

Source: rapid type analysis, Bacon and Sweeney 1996, "Fast static analysis of C++ virtual function calls", OOPSLA.
"""

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TypeAlias

OURS = "sojourn_"
_CHECKS = ("validator", "serializer")
_Function = ast.FunctionDef | ast.AsyncFunctionDef
_Name: TypeAlias = tuple[str, str]
"""Module and name; DOTTED for a module: of whatever it is an attribute."""
DOTTED = ""


@dataclass
class _Place:
    """A function, or all of a module or class that runs when it is read.

    Args:
        path, line: where its definition begins. keys: names any of which makes it live.
        owner: the class that has to be live, too; None: none has.
    """

    path: Path
    line: int
    keys: tuple[_Name, ...]
    owner: _Name | None = None
    names: set[_Name] = field(default_factory=set)
    """That it uses."""


def reachable(modules: Iterable[str], names: Iterable[str]) -> dict[Path, frozenset[int]]:
    """First lines of the functions that can be come to, by file.

    Args:
        modules: to begin with, in full. names: used from outside, whatever module has them.
    """
    entries, outside = set(_entries()), set(names)
    imported = _imported({*modules, *(module for module, _ in entries)})
    whole = {module for each in imported for module in _scope(each).modules.values()}
    waiting = {_origin(*entry) for entry in entries} | {(DOTTED, name) for name in outside}
    by_name: dict[_Name, list[_Place]] = defaultdict(list)
    for module in imported:
        for place in _places(module):
            if not place.keys:
                waiting |= place.names
            names_here = {name for _, name in place.keys}
            any_way = {(DOTTED, name) for name in names_here if module in whole or name in outside}
            for key in {*place.keys, *any_way}:
                by_name[key].append(place)
    return _live(by_name, waiting)


def _live(by_name: Mapping[_Name, list[_Place]], first: set[_Name]) -> dict[Path, frozenset[int]]:
    """First lines of the places that are named from these names on, by file."""
    found: dict[Path, set[int]] = defaultdict(set)
    waiting, seen = set(first), set[_Name]()
    held_back: dict[_Name, list[_Place]] = defaultdict(list)
    """Named, but their class is not live yet."""
    classes = set[_Name]()
    while waiting:
        name = waiting.pop()
        seen.add(name)
        ready = list(by_name.get(name, ()))
        while ready:
            place = ready.pop()
            if place.owner is not None and place.owner not in classes:
                held_back[place.owner].append(place)
                continue
            found[place.path].add(place.line)
            waiting |= place.names - seen
            new = set(place.keys) - classes
            classes |= new
            ready += [each for key in new for each in held_back.pop(key, ())]
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


@dataclass(frozen=True)
class _Scope:
    """What names stand for in a module, wherever in it they are imported.

    Args:
        names: module and name of what is imported from one. modules: those imported as a whole, by name.
        own: what the module itself has.
    """

    names: Mapping[str, _Name]
    modules: Mapping[str, str]
    own: frozenset[str]


@cache
def _scope(module: str) -> _Scope:
    names: dict[str, _Name] = {}
    modules: dict[str, str] = {}
    tree = _tree(_path(module))
    for node in _executed(tree):
        if isinstance(node, ast.Import):
            modules |= {alias.asname or alias.name: alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                if _file(inner) is not None:
                    modules[alias.asname or alias.name] = inner
                else:
                    names[alias.asname or alias.name] = (node.module, alias.name)
    own = {node.name for node in tree.body if isinstance(node, _Function | ast.ClassDef)}
    ours = {name: inner for name, inner in modules.items() if inner.startswith(OURS)}
    return _Scope(names, ours, frozenset(own))


def _origin(module: str, name: str) -> _Name:
    """Where a name of a module is defined, which may have it from another."""
    if _file(module) is not None:
        scope = _scope(module)
        if name not in scope.own and name in scope.names and scope.names[name] != (module, name):
            return _origin(*scope.names[name])
    return module, name


def _path(module: str) -> Path:
    path = _file(module)
    if path is None:
        raise ModuleNotFoundError(module)
    return path


def _executed(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all in it but what stands under TYPE_CHECKING."""
    yield node
    if isinstance(node, ast.If) and "TYPE_CHECKING" in _words(node.test):
        return
    for child in ast.iter_child_nodes(node):
        yield from _executed(child)


def _places(module: str) -> Iterator[_Place]:
    path = _path(module)
    top = _Place(path, 0, ())
    yield from _within(_tree(path).body, top, module, None)
    yield top


def _within(body: Iterable[ast.stmt], around: _Place, module: str, owner: _Name | None) -> Iterator[_Place]:
    """Functions of a body; what else stands there is of the place around it."""
    for node in body:
        if isinstance(node, _Function):
            for decorator in node.decorator_list:
                around.names |= _named(decorator, module)
            keys: tuple[_Name, ...] = ((module, node.name),)
            if owner is not None:
                keys = (owner,) if _by_itself(node) else ((module, node.name), (DOTTED, node.name))
            names = {name for part in (*node.body, node.args) for name in _named(part, module)}
            yield _Place(around.path, node.lineno, keys, None if owner in keys else owner, names)
        elif isinstance(node, ast.ClassDef):
            names = {name for part in (*node.bases, *node.decorator_list) for name in _named(part, module)}
            here = (module, node.name)
            inside = _Place(around.path, node.lineno, (here,) if owner is None else (here, (DOTTED, node.name)))
            inside.names |= names
            yield from _within(node.body, inside, module, here)
            yield inside
        elif not isinstance(node, ast.Import | ast.ImportFrom):
            around.names |= _named(node, module)


def _by_itself(node: _Function) -> bool:
    """Whether nobody has to name it: Python does, or pydantic."""
    dunder = node.name.startswith("__") and node.name.endswith("__")
    decorators = {each for decorator in node.decorator_list for each in _words(decorator)}
    return dunder or any(name.endswith(_CHECKS) for name in decorators)


def _words(node: ast.AST) -> Iterator[str]:
    """Names and attributes in it, as they are written."""
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            yield each.id
        elif isinstance(each, ast.Attribute):
            yield each.attr


def _named(node: ast.AST, module: str) -> set[_Name]:
    """What it uses, in a module: names, as what they are bound to, and attributes, of a module or of anything."""
    scope, found = _scope(module), set()
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            found.add(_origin(module, each.id))
        elif isinstance(each, ast.Attribute):
            found.add((DOTTED, each.attr))
            if isinstance(each.value, ast.Name) and each.value.id in scope.modules:
                found.add(_origin(scope.modules[each.value.id], each.attr))
    return found
