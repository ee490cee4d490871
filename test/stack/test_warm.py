"""What is ready before a run: none of its periods waits for a compiler, nor for a compiled kernel to be loaded."""

import json
import subprocess
import sys

import pytest

LOADED = """
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
    return {f"{kernel.py_func.__name__}{types}" for kernel in kernels for types in kernel.signatures}

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


@pytest.mark.parametrize(
    ("scenario", "periods"), [("lunar_sample", 500), ("obstacle_course", 1500), ("drill_sample", 800)]
)
def test_no_period_of_a_run_loads_a_kernel(scenario: str, periods: int) -> None:
    command = [sys.executable, "-c", LOADED, scenario, str(periods)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, check=True)
    assert json.loads(done.stdout.splitlines()[-1]) == []
