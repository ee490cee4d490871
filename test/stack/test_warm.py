"""What is ready before a run: none of its periods waits for a compiler, nor for a compiled kernel to be loaded."""

import json
import subprocess
import sys

import pytest

KERNELS = """
import json, sys
from numba.core.dispatcher import Dispatcher
from sojourn_config.scenario import load_scenario
from sojourn_contract.topics import ROLES
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Stack

def signatures():
    kernels = {
        value
        for name, module in list(sys.modules.items())
        if name.startswith("sojourn_")
        for value in vars(module).values()
        if isinstance(value, Dispatcher)
    }
    return {
        f"{kernel.py_func.__module__}.{kernel.py_func.__name__}{types}"
        for kernel in kernels
        for types in kernel.signatures
    }
"""
RUN = """
apps = make_apps(load_scenario(sys.argv[1], sys.argv[3:]), ROLES)
for app in apps.values():
    app.warm_up()
stack, before = Stack(apps, ROLES), signatures()
state, _ = stack.begin()
for _ in range(int(sys.argv[2])):
    state, _ = stack.step(state)
    if state.finished:
        break
print(json.dumps(sorted(signatures() - before)))
"""
MADE = """
make_apps(load_scenario(sys.argv[1]), ROLES)
print(json.dumps(sorted(signatures())))
"""


def kernels_of(program: str, *arguments: str) -> list[str]:
    """What a program prints last, in a process of its own."""
    command = [sys.executable, "-c", KERNELS + program, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, check=True)
    kernels: list[str] = json.loads(done.stdout.splitlines()[-1])
    return kernels


@pytest.mark.parametrize(
    ("scenario", "periods"), [("lunar_sample", 500), ("obstacle_course", 1500), ("drill_sample", 800)]
)
def test_no_period_of_a_run_loads_a_kernel(scenario: str, periods: int) -> None:
    assert kernels_of(RUN, scenario, str(periods)) == []


def test_an_app_that_is_only_made_loads_no_kernel_of_its_periods() -> None:
    """Those of the camera, of the map of the ground, and of the arm; to know the ground itself takes some."""
    made = kernels_of(MADE, "lunar_sample")
    of_periods = ("sojourn_physics.sensors.", "sojourn_flight.hazards.", "sojourn_flight.arm.")
    assert [kernel for kernel in made if kernel.startswith(of_periods)] == []
    assert made, "the ground"
