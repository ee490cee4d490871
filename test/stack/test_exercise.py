"""Lines in functions that a piece of work goes through, on a module of which it is known."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from sojourn_stack.exercise import exercised, folders_of, joined, share

TEXT = '''"""A module."""

LIMIT = 3


def limited(value):
    """Docstrings are no statements."""
    if value > LIMIT:
        value = LIMIT
    elif value < 0:
        raise ValueError(
            "negative"
        )
    return value


class Never:
    def called(self):
        return 1

    def for_others(self):
        """What they do."""
        raise NotImplementedError

    def half_of_it(self):
        self.called()
        raise NotImplementedError("the other half")
'''
LINES = {8, 9, 10, 11, 14, 19, 26, 27}


@pytest.fixture
def module(tmp_path: Path) -> ModuleType:
    path = tmp_path / "laws" / "limits.py"
    path.parent.mkdir()
    path.write_text(TEXT, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("limits", path)
    assert spec is not None and spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def test_lines_are_those_that_ran(module: ModuleType, tmp_path: Path) -> None:
    folder, path = tmp_path / "laws", tmp_path / "laws" / "limits.py"
    high = exercised(lambda: module.limited(5), [folder])
    assert high[path].lines == LINES and high[path].run == {8, 9, 14}
    assert high[path].refusals == {11, 27} and high[path].missed == [10, 11, 19, 26, 27]

    def refused() -> None:
        with pytest.raises(ValueError, match="negative"):
            module.limited(-1)

    low = exercised(refused, [folder])
    assert low[path].run == {8, 10, 11}
    both = joined(high, low)
    assert both[path].run == {8, 9, 10, 11, 14}
    assert share(list(both.values())) == pytest.approx(5 / 8)


def test_nothing_to_run_is_all_run() -> None:
    assert share([]) == 1.0


def test_a_role_has_its_app_and_its_laws() -> None:
    names = [folder.name for folder in folders_of("drive")]
    assert names == ["sojourn_drive", "mobility", "odometry", "planning", "hazards", "supervision"]
    assert [folder.name for folder in folders_of("plant")] == ["sojourn_plant"]
    assert all(folder.is_dir() for role in ("drive", "arm", "power", "sensors", "plant") for folder in folders_of(role))
