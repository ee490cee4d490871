"""Programs as users start them, each with what it prints, what it starts, and what it must not leave behind."""

import atexit
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import pytest

from copied import new_fork_server
from domains import own_domain
from sojourn_bringup.forked import ForkRequest, ForkServer
from sojourn_machine import arithmetic

HERE = Path(__file__).parent
SHORT_RUN = HERE / "short_run.yaml"
LONGEST_S = 1800.0
"""Wall time after which a program hangs for certain: ten times what any of these takes, and more [s]."""
PATIENT = ("--start-timeout", "600", "--lockstep-timeout", "300")
"""Options of start.py and demo that let a busy machine be slow; they cost nothing where nobody falls silent."""
PATIENT_BENCH = ("--start-timeout", "600", "--timeout", "300")
"""The same for programs that stand in for a node: options of replay and of contract check."""
LAYOUTS = {"direct": ("--direct",), "processes": ()}
"""The two that have least in common. What is between them, the nodes of the second in one process (--composed), has its
own runs in test_same_run and test_same_everywhere."""
ELSEWHERE = {
    "OPENBLAS_NUM_THREADS": "4", "OMP_NUM_THREADS": "4", "NUMBA_NUM_THREADS": "2", "OPENBLAS_CORETYPE": "Sandybridge",
    "NUMBA_CPU_NAME": "generic", "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
}  # fmt: skip
"""What a user may have set: an older processor for each library that asks, and more threads than there are cores."""
FOUR_THREADS = {"OPENBLAS_NUM_THREADS": "4", "OMP_NUM_THREADS": "4", "OPENBLAS_CORETYPE": "Haswell"}
"""What a user may have set who has more cores than these."""
MODULES = {
    "action_command": "sojourn_operator.action_command",
    "bench": "sojourn_studies.bench",
    "checkpoint_client": "sojourn_operator.checkpoint_client",
    "compare": "sojourn_bags.compare_command",
    "console": "sojourn_console.console",
    "contract_tool": "sojourn_bringup.contract_tool",
    "datasheet": "sojourn_studies.rover_datasheet",
    "demo": "sojourn_bringup.demo",
    "goal_client": "sojourn_operator.goal_client",
    "measure_flood": "sojourn_studies.measure_flood",
    "measure_kills": "sojourn_studies.measure_kills",
    "replay": "sojourn_bringup.replay",
    "report": "sojourn_bags.report_command",
    "start": "sojourn_bringup.start",
    "tune": "sojourn_studies.tune",
}


def environment(outside: Mapping[str, str] | None = None) -> dict[str, str]:
    """Variables of the programs under test: as a user's shell has them, who may have set others `outside`.

    ROS checks the fields of every message.
    """
    shell = {**arithmetic.outer(os.environ), **(outside or {})}
    shell.pop("PYTEST_CURRENT_TEST", None)  # which is another one for each
    return {**shell, "ROS_PYTHON_CHECK_FIELDS": "1", "PYTHONUNBUFFERED": "1"}


@cache
def fork_server(variables: frozenset[tuple[str, str]]) -> ForkServer:
    """A process with these variables that has loaded what most programs load, which takes each of them longer than what
    many tests ask for. It ends with the tests.
    """
    log = Path(mkdtemp(prefix="sojourn_tests_")) / "fork_server.log"
    atexit.register(shutil.rmtree, log.parent)
    server = new_fork_server(log, dict(variables), "sojourn_bringup.start_run", "sojourn_bags.comparison")
    atexit.register(server.close)
    return server


class Program:
    """A program of ours in a session of its own, its output in a file.

    Args:
        name: which, of MODULES. arguments: its options. log: file for what it prints.
        outside: variables that its user has set.
    """

    def __init__(
        self, name: str, arguments: Sequence[str], log: Path, outside: Mapping[str, str] | None = None
    ) -> None:
        self.log = log
        log.write_bytes(b"")
        variables = environment(outside)
        request = ForkRequest(MODULES[name], arguments, str(log), variables, f"sojourn_{name}", in_own_session=True)
        process = fork_server(frozenset(variables.items())).fork(request)
        assert process is not None
        self.process = process

    @property
    def text(self) -> str:
        """What it has printed so far."""
        return self.log.read_text(encoding="utf-8")

    def processes(self) -> list[int]:
        """Numbers of it and of all that it has started, as far as they still run: those of its session."""
        found = []
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                state, _, _, session = (entry / "stat").read_text().rpartition(")")[2].split()[:4]
            except OSError:
                continue
            if int(session) == self.process.pid and state != "Z":
                found.append(int(entry.name))
        return sorted(found)

    def leaves_processes(self, seconds: float = 5.0) -> list[int]:
        """What of it still runs after so long; empty as soon as nothing does."""
        end = time.monotonic() + seconds
        while (left := self.processes()) and time.monotonic() < end:
            time.sleep(0.05)
        return left

    def process_of(self, role: str) -> int:
        """Number of the latest process of a role, from what it has printed."""
        found = re.findall(rf"^{role} \(process (\d+)\)", self.text, re.MULTILINE)
        found += re.findall(rf"^{role} .*started again as process (\d+)", self.text, re.MULTILINE)
        return int(found[-1])

    def send(self, number: signal.Signals) -> None:
        """Send a signal to it alone."""
        os.kill(self.process.pid, number)

    def wait(self, seconds: float = LONGEST_S) -> int:
        """Its exit status, once it has ended."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            pytest.fail(f"still runs after {seconds:g} s; it printed:\n{self.text}")

    def wait_until(self, holds: Callable[[str], bool], what: str, seconds: float = LONGEST_S) -> None:
        """Wait until what it has printed fulfils a condition."""
        end = time.monotonic() + seconds
        while not holds(self.text):
            if time.monotonic() > end or self.process.poll() is not None:
                pytest.fail(f"{what}: not seen; it printed:\n{self.text}")
            time.sleep(0.02)

    def end(self) -> None:
        """End it if it still runs."""
        if self.process.poll() is None:
            self.send(signal.SIGINT)
            try:
                self.process.wait(20.0)
            except subprocess.TimeoutExpired:
                self.send(signal.SIGKILL)
                self.process.wait(LONGEST_S)


def with_long(names: Iterable[str], long: Collection[str]) -> list[Any]:
    """Values of a parameter, marked as long where they are."""
    return [pytest.param(name, marks=pytest.mark.long) if name in long else name for name in names]


def chosen(request: pytest.FixtureRequest, name: str) -> list[Any]:
    """Values of a parameter with which tests of this module are to run: nobody else's runs have to be made."""
    here = [item for item in request.session.items if item.path == request.path and hasattr(item, "callspec")]
    return list(dict.fromkeys(item.callspec.params[name] for item in here if name in item.callspec.params))


def demos(options: Mapping[str, Sequence[str]], folder: Path) -> dict[str, tuple[int, str, Path]]:
    """Run demos in processes of their own, two at once: one alone leaves cores idle.

    Args:
        options: of each demo, by name. folder: of all; each has its name in it.

    Returns:
        for each its exit status, the end of what it said, and its folder.
    """

    def demo(name: str) -> tuple[int, str, Path]:
        with own_domain() as domain:
            place = ["--run-dir", str(folder / name), "--domain", str(domain)]
            command = [sys.executable, "-m", "sojourn_bringup.demo", *options[name], *PATIENT, *place]
            done = subprocess.run(
                command, env=environment(), capture_output=True, text=True, timeout=LONGEST_S, check=False
            )
        return done.returncode, done.stdout[-2000:] + done.stderr[-2000:], folder / name

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(options, pool.map(demo, options), strict=True))


def shared_memory_files() -> set[str]:
    """Shared-memory files of ROS and of its tracing that no process uses: what a run would have left behind."""
    files = {str(path) for path in Path("/dev/shm").iterdir() if re.search("fastrtps|lttng-ust", path.name)}
    used = set()
    for maps in Path("/proc").glob("[0-9]*/maps"):
        try:
            used |= {line.split()[-1] for line in maps.read_text(errors="replace").splitlines() if "/dev/shm/" in line}
        except OSError:
            continue
    return files - used
