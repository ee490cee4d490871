"""How the code is shaped: argument lists, names of classes and modules stay of a size that can be held in mind."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
MODULES = sorted(ROOT.glob("src/*/*/**/*.py"))
MOST_PARAMETERS = 9
MOST_LINES = 400


def nodes() -> Iterator[tuple[str, ast.AST]]:
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), filename=str(path))):
            if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
                yield f"{path.relative_to(ROOT)}:{node.lineno}", node


def parameters(function: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> int:
    given = function.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return sum(one is not None for one in named)


def test_every_package_is_looked_at() -> None:
    packages = {path.relative_to(ROOT).parts[1] for path in MODULES}
    assert packages == {path.name for path in ROOT.glob("src/sojourn_*")}
    assert len(MODULES) > 400


def test_parameters_of_every_kind_count() -> None:
    (function,) = ast.parse("def f(a, /, b, c=1, *d, e, g=2, **h): ...").body
    assert isinstance(function, ast.FunctionDef) and parameters(function) == 7


def test_no_function_has_ten_parameters() -> None:
    """What belongs together is one value with a name."""
    found = {
        f"{place} {getattr(node, 'name', 'lambda')}": parameters(node)
        for place, node in nodes()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
    }
    assert len(found) > 3000
    assert {name: count for name, count in found.items() if count > MOST_PARAMETERS} == {}


def test_no_two_classes_share_a_name() -> None:
    """Who reads or looks for a name finds one thing."""
    places = defaultdict(list)
    for place, node in nodes():
        if isinstance(node, ast.ClassDef):
            places[node.name].append(place)
    assert len(places) > 700
    assert {name: found for name, found in places.items() if len(found) > 1} == {}


def test_no_module_is_longer_than_can_be_read_at_once() -> None:
    lines = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8").count("\n") for path in MODULES}
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}
