"""The help of every script answers at once: its options load none of the libraries that its work needs."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
MODULES = {
    path.name: found[1]
    for path in sorted(SCRIPTS.iterdir())
    if path.is_file()
    and path.name != "setup"  # which has the kernels compiled
    and (found := re.search(r'-m"?,? "?(sojourn_\w+(?:\.\w+)+)', path.read_text(encoding="utf-8")))
}
"""Module by script."""
HEAVY = ("numba", "scipy", "matplotlib", "pinocchio", "rclpy", "distributed")
PROGRAM = """
import runpy, sys
module, *heavy = sys.argv[1:]
sys.argv[1:] = ["--help"]
try:
    runpy.run_module(module, run_name="__main__", alter_sys=True)
except SystemExit as end:
    assert not end.code, end.code
print("loaded:", *(name for name in heavy if name in sys.modules))
"""


def test_the_scripts_are_found() -> None:
    assert len(MODULES) >= 17 and {"start.py", "goal", "report", "rover_datasheet"} <= MODULES.keys()


@pytest.mark.parametrize("script", MODULES)
def test_help_loads_no_heavy_library(script: str) -> None:
    command = [sys.executable, "-c", PROGRAM, MODULES[script], *HEAVY]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    told, _, loaded = done.stdout.rpartition("loaded:")
    assert "usage:" in told
    assert not loaded.split()


def test_a_goal_loads_no_mechanics() -> None:
    """It is sent many times a day: what faults and links of all machines are is for others to know."""
    heavy = [*HEAVY[:4], "sojourn_physics"]
    program = "import sys, sojourn_operator.goal_command; print(*(one for one in sys.argv[1:] if one in sys.modules))"
    done = subprocess.run([sys.executable, "-c", program, *heavy], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not done.stdout.split()
