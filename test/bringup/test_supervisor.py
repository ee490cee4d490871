"""The supervisor with stand-in nodes as processes: what it does when one dies, and that it leaves nothing behind."""

import contextlib
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sojourn_bringup.child import STOP_S
from sojourn_contract.process import TEARDOWN_S

RUN = Path(__file__).parent / "fake_run.py"
LIMIT_S = 600.0
SHARED_MEMORY = Path("/dev/shm")
ROLES = ("plant", "sensors")


class Run:
    """A supervisor in a process of its own; what it says is read line by line."""

    def __init__(self, folder: Path, domain: int, kind: str, **manners: str) -> None:
        chosen = {role: "good" for role in ROLES} | manners
        self.folder = folder
        self.process = subprocess.Popen(
            [sys.executable, str(RUN), str(folder), str(domain), kind, *(f"{r}={m}" for r, m in chosen.items())],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.lines: list[str] = []
        self._arriving: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        """Reading in a thread of its own lets a line that never comes fail the test, and not hang it."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._arriving.put(line.rstrip())
        self._arriving.put(None)

    def _next_line(self, awaited: str) -> str:
        try:
            line = self._arriving.get(timeout=LIMIT_S)
        except queue.Empty:
            line = None
        if line is None:
            raise AssertionError(f"never said {awaited!r}: " + "\n".join(self.lines))
        self.lines.append(line)
        return line

    def wait_for(self, pattern: str) -> re.Match[str]:
        """The first line from here on that holds a pattern."""
        while not (found := re.search(pattern, self._next_line(pattern))):
            pass
        return found

    def wait_for_state(self, role: str, state: str) -> re.Match[str]:
        """Until what was last said of a node, be it before or after this call, is a state: gives its process number."""
        pattern = rf"^{role} \(process (\d+)\): .*{re.escape(state)}"
        while not (said := [re.search(pattern, line) for line in self.lines if line.startswith(f"{role} (")]) or not (
            found := said[-1]
        ):
            self._next_line(f"{role}: {state}")
        return found

    def end(self) -> dict[str, Any]:
        """Its outcome, with the status that it ended with."""
        self.process.wait(LIMIT_S)
        while (line := self._arriving.get(timeout=LIMIT_S)) is not None:
            self.lines.append(line)
        outcome = json.loads(self.lines[-1])
        assert outcome["status"] == self.process.returncode
        return outcome

    @property
    def children(self) -> set[int]:
        """Every process that it said it has started."""
        return {int(number) for line in self.lines for number in re.findall(r"process (\d+)", line)}


def is_alive(number: int) -> bool:
    """Whether a process runs (one that has ended and is not yet reaped does not)."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def all_gone(numbers: set[int], within_s: float = 10.0) -> bool:
    """Whether none of the processes runs, at once or a moment later."""
    end = time.monotonic() + within_s
    while any(map(is_alive, numbers)) and time.monotonic() < end:
        time.sleep(0.05)
    return not any(map(is_alive, numbers))


@pytest.fixture
def start(tmp_path: Path, domain: int) -> Iterator[Callable[..., Run]]:
    """Starts a run, and cleans up after a test that failed."""
    runs: list[Run] = []

    def make(kind: str, **manners: str) -> Run:
        folder = tmp_path / f"run_{len(runs)}"
        folder.mkdir()
        runs.append(Run(folder, domain, kind, **manners))
        return runs[-1]

    before = {path.name for path in SHARED_MEMORY.glob("*fastrtps*")}
    yield make
    for run in runs:
        if run.process.poll() is None:
            run.process.kill()
            run.process.wait()
        for number in run.children:
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
    assert {path.name for path in SHARED_MEMORY.glob("*fastrtps*")} <= before


def test_a_run_that_the_plant_ends_is_a_success_and_leaves_no_process(start: Callable[..., Run]) -> None:
    run = start("lockstep", plant="brief")
    outcome = run.end()
    assert outcome["status"] == 0 and outcome["message"] == "the run ended"
    assert outcome["sim_time_s"] == pytest.approx(1.0, abs=0.021)
    assert len(run.children) == len(ROLES) and all_gone(run.children)
    assert {path.stem for path in (run.folder / "logs").iterdir()} == set(ROLES)


def test_in_lockstep_a_killed_node_stops_the_run_and_is_named(start: Callable[..., Run]) -> None:
    run = start("lockstep")
    number = int(run.wait_for(r"sensors \(process (\d+)\): running")[1])
    os.kill(number, signal.SIGKILL)
    outcome = run.end()
    assert outcome["status"] == 1
    assert f"sensors (process {number}) was killed by SIGKILL" in outcome["message"]
    assert all_gone(run.children)


def test_in_real_time_a_killed_node_is_started_again(start: Callable[..., Run]) -> None:
    run = start("realtime")
    first = int(run.wait_for(r"sensors \(process (\d+)\): running")[1])
    os.kill(first, signal.SIGKILL)
    again = run.wait_for(rf"sensors \(process {first}\) was killed by SIGKILL: started again as process (\d+)")
    second = int(run.wait_for(r"sensors \(process (\d+)\): running")[1])
    assert second == int(again[1]) != first
    assert is_alive(second)
    run.process.send_signal(signal.SIGINT)
    outcome = run.end()
    assert outcome["message"] == "interrupted" and outcome["status"] == 0  # no scripted operator takes part
    assert all_gone(run.children)


def test_a_node_that_dies_again_and_again_is_given_up(start: Callable[..., Run]) -> None:
    run = start("realtime")
    for _ in range(3):
        os.kill(int(run.wait_for(r"sensors \(process (\d+)\): running")[1]), signal.SIGKILL)
        run.wait_for("started again")
    os.kill(int(run.wait_for(r"sensors \(process (\d+)\): running")[1]), signal.SIGKILL)
    outcome = run.end()
    assert outcome["status"] == 1 and "not started again" in outcome["message"] and "sensors" in outcome["message"]
    assert all_gone(run.children)


def test_without_its_plant_a_run_in_real_time_ends(start: Callable[..., Run]) -> None:
    run = start("realtime")
    number = int(run.wait_for(r"plant \(process (\d+)\): running")[1])
    os.kill(number, signal.SIGKILL)
    outcome = run.end()
    assert outcome["status"] == 1 and f"plant (process {number}) was killed by SIGKILL" in outcome["message"]
    assert all_gone(run.children)


def test_a_node_that_cannot_start_ends_the_run_with_its_last_words(start: Callable[..., Run]) -> None:
    outcome = start("realtime", sensors="never").end()
    assert outcome["status"] == 1
    assert "sensors" in outcome["message"] and "the hardware is not there" in outcome["message"]


def test_a_program_that_is_not_there_is_named(start: Callable[..., Run]) -> None:
    outcome = start("lockstep", sensors="!/nowhere/driver --fast").end()
    assert outcome["status"] == 1 and "/nowhere/driver cannot be started" in outcome["message"]


def test_what_a_node_has_started_ends_with_it_and_a_stubborn_node_is_killed(start: Callable[..., Run]) -> None:
    run = start("lockstep", sensors="parent", plant="stubborn")
    run.wait_for("sensors .*: running")
    grandchild = int((run.folder / "logs" / "sensors.log").read_text().split()[0])
    assert is_alive(grandchild)
    run.process.send_signal(signal.SIGINT)
    run.end()
    assert any("plant" in line and "killed" in line for line in run.lines)
    assert all_gone(run.children | {grandchild})


def test_a_node_whose_middleware_does_not_come_back_ends_itself_before_it_is_killed() -> None:
    """It has that long from its farewell on, which a busy host may keep it from for some seconds."""
    assert STOP_S >= TEARDOWN_S + 5.0


def test_the_nodes_die_with_their_supervisor(start: Callable[..., Run]) -> None:
    run = start("lockstep")
    run.wait_for("plant .*: running")
    assert len(run.children) == len(ROLES) and all(map(is_alive, run.children))
    run.process.kill()
    run.process.wait()
    assert all_gone(run.children)


def test_in_real_time_a_stopped_node_is_named_and_the_others_say_for_whom_they_wait(start: Callable[..., Run]) -> None:
    """SIGSTOP of the sensors: the drive is not silent, it waits."""
    run = start("realtime", drive="good")
    number = int(run.wait_for_state("sensors", "running")[1])
    run.wait_for_state("drive", "running")
    os.kill(number, signal.SIGSTOP)
    run.wait_for(rf"sensors \(process {number}\) is stopped: .*kill -CONT {number}")
    run.wait_for_state("drive", "stalled (waiting for /imu/data from sensors)")
    os.kill(number, signal.SIGCONT)
    run.wait_for_state("sensors", "running")
    run.process.send_signal(signal.SIGINT)
    run.end()
    assert all_gone(run.children)


@pytest.mark.parametrize("kind", ["lockstep", "realtime"])
def test_a_run_folder_that_is_removed_ends_the_run_at_once(start: Callable[..., Run], kind: str) -> None:
    run = start(kind)
    run.wait_for("sensors .*: running")
    run.folder.rename(run.folder.with_name("elsewhere"))
    outcome = run.end()
    assert outcome["status"] == 1 and outcome["message"] == (
        f"the run folder {run.folder} is gone: somebody has removed or renamed it"
    )
    assert all_gone(run.children)
