"""What `scripts/validation` tells of marked tests, and what it leaves out."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
OF_ANOTHER = '''
import numpy as np
import pytest

@pytest.mark.published("Newton 1687")
@pytest.mark.parametrize("height", [20.0])
def test_a_fall(height, record_property):
    """Of an apple."""
    record_property("median error of the trials", "3 %")
    assert 2.02 == pytest.approx(2.0, rel=0.02)
    assert np.array([1.0, 3.0]) == pytest.approx(np.array([1.0, 3.003]), abs=0.01)
    assert 0.1 + 0.2 == pytest.approx(0.3)
    assert 0.1 + 0.2 == pytest.approx(0.3, rel=1e-12)

@pytest.mark.published
def test_a_fall_from_afar():
    assert 5.0 == pytest.approx(4.0, abs=0.5)

def test_of_no_source():
    assert 7.0 == pytest.approx(7.1, abs=0.5)
'''


@pytest.mark.parametrize("processes", ["0", "2"])
def test_it_tells_published_figures_and_no_others(tmp_path: Path, processes: str) -> None:
    (tmp_path / "test_falls.py").write_text(OF_ANOTHER, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = published(source)\n", encoding="utf-8")
    plugins = ("-p", "published_figures", "-p", "xdist.plugin", "-p", "no:cacheprovider")
    command = [sys.executable, "-m", "pytest", *plugins, "-m", "published", "-n", processes, "--csv", "figures.csv"]
    paths = {"PATH": "", "PYTHONPATH": str(TESTS), "SOJOURN_CALLED_FROM": str(tmp_path)}
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env=paths | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stdout + done.stderr
    assert "4 published figures, 1 farther off than allowed." in done.stdout
    assert "Newton 1687. Of an apple." in done.stdout
    assert "median error of the trials: 3 %" in done.stdout
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert "[20.0] 2.02 2 2.02 +1 % 2 %" in lines
    assert "5.0 4 5 +25 % 12 %" in lines
    with (tmp_path / "figures.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert sorted((float(row["published"]), float(row["ours"])) for row in rows) == [
        (1.0, 1.0), (2.0, 2.02), (3.003, 3.0), (4.0, 5.0),
    ]  # fmt: skip
