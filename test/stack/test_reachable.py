"""Which functions an app can come to, on files of which it is known."""

from pathlib import Path

import pytest

from sojourn_stack.exercise import functions_of_apps
from sojourn_stack.reachable import reachable

APP = """
from sojourn_made_up.laws import Law, unused

class App:
    def step(self):
        return Law().act()

    def never(self):
        return unused()
"""
LAWS = """
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sojourn_made_up.tools

def helper():
    def inner():
        return 1
    return inner()

def unused():
    return 2

START = helper()

class Law:
    def __init__(self):
        self.value = 3

    def act(self):
        return self.value

    def drawn_by_nobody(self):
        return self.value
"""


def test_what_is_named_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "sojourn_made_up"
    folder.mkdir()
    for name, text in (("__init__", ""), ("app", APP), ("laws", LAWS), ("tools", "def draw():\n    return 4\n")):
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    found = reachable(["sojourn_made_up.app"], {"App", "step"})
    lines = LAWS.splitlines()
    named = {lines[line - 1].strip() for line in found[folder / "laws.py"]}
    assert {"def helper():", "def __init__(self):", "def act(self):", "class Law:"} == named
    assert folder / "tools.py" not in found
    assert APP.splitlines().index("    def step(self):") + 1 in found[folder / "app.py"]
    assert APP.splitlines().index("    def never(self):") + 1 not in found[folder / "app.py"]


BOUND = """
from sojourn_bound.laws import Used, chosen as taken
from sojourn_bound import whole

class App:
    def step(self):
        return Used().value + taken() + whole.of_the_module() + self.state.attribute
"""
BOUND_LAWS = """
from sojourn_bound.far import chosen

class Base:
    @property
    def value(self):
        return self.inherited()

    def inherited(self):
        return 1

class Used(Base):
    pass

class NotMade:
    def value(self):
        return 2

    def __init__(self):
        self.value()

def attribute():
    return 3

def step():
    return 4
"""
FAR = """
def chosen():
    return 5

def taken():
    return 6
"""
WHOLE = """
def of_the_module():
    return 7

def attribute():
    return 8
"""


def test_a_name_is_what_it_is_bound_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "sojourn_bound"
    folder.mkdir()
    texts = {"__init__": "", "app": BOUND, "laws": BOUND_LAWS, "far": FAR, "whole": WHOLE}
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    found = reachable(["sojourn_bound.app"], {"App"})
    named = {
        texts[path.stem].splitlines()[line - 1].strip()
        for path, lines in found.items()
        if path.parent == folder and path.stem != "app"
        for line in lines
    }
    assert named == {
        "class Base:",
        "def value(self):",
        "def inherited(self):",
        "class Used(Base):",
        "def chosen():",
        "def of_the_module():",
        "def attribute():",
    }
    laws = {texts["laws"].splitlines()[line - 1].strip() for line in found[folder / "laws.py"]}
    assert "class NotMade:" not in laws and "def attribute():" not in laws
    assert FAR.splitlines().index("def taken():") + 1 not in found[folder / "far.py"]


def test_of_the_flight_laws_the_tools_of_analysis_do_not_count() -> None:
    names = {path.name: lines for path, lines in functions_of_apps().items() if "sojourn_flight" in path.parts}
    assert {"goal_follower.py", "drive.py", "law.py", "dig.py", "jogging.py"} <= names.keys()
    assert "dh_extract.py" not in names
