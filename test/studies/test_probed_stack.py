"""What becomes of a stack that is probed when whoever probes it is told to end."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from domains import own_domain

PATIENCE_S = 300.0
"""Wall time after which the test gives up."""
PROBE = """
import signal, sys, time
from pathlib import Path
from sojourn_config.command_line import run_script
from sojourn_studies.probed_stack import ProbedStack

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell has what runs in its background ignore it

def main(_):
    with ProbedStack(["flat_drive", "--composed"], int(sys.argv[1]), Path(sys.argv[2])) as stack:
        print(stack._process.pid, flush=True)
        time.sleep(1e6)

run_script(main)
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_stack_does_not_outlive_its_probe(tmp_path: Path, number: signal.Signals) -> None:
    """It was left behind by SIGTERM, and kept its domain."""
    with own_domain() as domain:
        command = [sys.executable, "-c", PROBE, str(domain), str(tmp_path / "run")]
        probe = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert probe.stdout is not None
        stack = psutil.Process(int(probe.stdout.readline()))
        try:
            probe.send_signal(number)
            assert probe.wait(PATIENCE_S) == 130
            end = time.monotonic() + PATIENCE_S
            while stack.is_running() and time.monotonic() < end:
                time.sleep(0.05)
            assert not stack.is_running()
        finally:
            for one in (probe, stack):
                try:
                    one.kill()
                except (psutil.NoSuchProcess, ProcessLookupError):
                    continue
