"""Nodes as copies of one process: each a process of its own in name, group, log and end, and none is left behind."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from copied import new_fork_server
from sojourn_bringup.child import Child
from sojourn_bringup.forked import ForkRequest, ForkServer, fork_server_for
from sojourn_bringup.process_table import process
from sojourn_config.ros_environment import own_environment
from sojourn_machine import arithmetic

LONGEST_S = 300.0
"""Wall time of what takes seconds on a machine that does nothing else [s]."""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ForkServer]:
    made = new_fork_server(tmp_path / "server.log", own_environment(os.environ, {}))
    yield made
    made.close()


@pytest.fixture
def node(server: ForkServer, tmp_path: Path) -> Callable[..., Child]:
    """A node that waits for others of which none comes."""

    def begin(role: str, **parameters: str) -> Child:
        given = {"scenario": "flat_drive", "participants": "[plant, drive]", **parameters}
        words = ["--ros-args", *(word for name, value in given.items() for word in ("-p", f"{name}:={value}"))]
        log = tmp_path / f"{role}.log"
        environment = own_environment(os.environ, {})
        copy = server.fork(ForkRequest(process(role).module, words, str(log), environment, title=f"sojourn_{role}"))
        assert copy is not None
        return Child(role, copy, log)

    return begin


def comes(is_so: Callable[[], bool]) -> bool:
    """Whether something comes to be so."""
    until = time.monotonic() + LONGEST_S
    while not is_so() and time.monotonic() < until:
        time.sleep(0.02)
    return is_so()


def title_of(child: Child) -> str:
    """As `ps` shows it."""
    return Path(f"/proc/{child.pid}/cmdline").read_bytes().replace(b"\0", b" ").decode().strip()


def handles(child: Child, number: signal.Signals) -> bool:
    """Whether it has begun to take a signal itself (proc(5), SigCgt)."""
    (caught,) = [line for line in Path(f"/proc/{child.pid}/status").read_text().splitlines() if "SigCgt" in line]
    return bool(int(caught.split()[1], 16) >> (number - 1) & 1)


def test_each_is_a_process_of_its_own(server: ForkServer, node: Callable[..., Child]) -> None:
    plant, drive = node("plant"), node("drive")
    assert len({plant.pid, drive.pid, os.getpid()}) == 3
    for child in (plant, drive):
        assert os.getpgid(child.pid) == child.pid
        assert comes(lambda child=child: title_of(child) == f"sojourn_{child.role}")  # type: ignore[misc]
        assert child.status is None
    plant.send(signal.SIGKILL)
    assert plant.wait(LONGEST_S) and plant.status == -signal.SIGKILL
    assert plant.how_it_ended() == "was killed by SIGKILL"
    assert not drive.wait(0.05) and drive.status is None, "the other one goes on"
    drive.send(signal.SIGSTOP)
    assert comes(lambda: drive.is_stopped)
    drive.send(signal.SIGCONT)
    assert comes(lambda: handles(drive, signal.SIGTERM))
    drive.send(signal.SIGTERM)
    assert drive.wait(LONGEST_S) and drive.status == 0


def test_a_copy_computes_as_a_program_that_starts_by_itself(server: ForkServer, tmp_path: Path) -> None:
    """With the variables of a user's shell it compiled for this processor, and had other values than anywhere else."""
    told = f"import os; print([os.environ.get(name) for name in {list(arithmetic.pins())}])"
    log = tmp_path / "copy.log"
    request = ForkRequest("timeit", ["-n", "1", "-r", "1", told], str(log), arithmetic.outer(os.environ))
    copy = server.fork(request)
    assert copy is not None and copy.wait(LONGEST_S) == 0
    assert log.read_text().splitlines()[0] == str(list(arithmetic.pins().values()))


def test_what_a_node_cannot_read_is_in_its_own_log(node: Callable[..., Child], tmp_path: Path) -> None:
    wrong = node("drive", scenario="no_such_scenario")
    assert wrong.wait(LONGEST_S) and wrong.status not in (0, None)
    assert "no_such_scenario" in wrong.how_it_ended()
    assert "no_such_scenario" in (tmp_path / "drive.log").read_text()


def test_with_their_server_they_end_and_no_more_are_made(server: ForkServer, node: Callable[..., Child]) -> None:
    plant = node("plant")
    (parent,) = [line for line in Path(f"/proc/{plant.pid}/status").read_text().splitlines() if "PPid" in line]
    os.kill(int(parent.split()[1]), signal.SIGKILL)
    assert plant.wait(LONGEST_S) and plant.status == -signal.SIGKILL
    assert server.is_gone and server.is_loaded()
    assert comes(lambda: not Path(f"/proc/{plant.pid}").exists())
    assert server.fork(ForkRequest("sojourn_drive", (), os.devnull, {})) is None


def test_a_node_with_more_variables_than_a_message_holds_is_to_start_by_itself(
    server: ForkServer, node: Callable[..., Child]
) -> None:
    for size in (150_000, 1_500_000):  # the one would be cut, the other never be sent
        assert server.fork(ForkRequest("sojourn_drive", (), os.devnull, {"LONG": "x" * size})) is None
    assert not server.is_gone and node("plant").status is None


def test_it_takes_what_still_runs_with_it(server: ForkServer, node: Callable[..., Child]) -> None:
    assert comes(server.is_loaded) and not server.is_gone
    plant = node("plant")
    server.close()
    assert comes(lambda: not Path(f"/proc/{plant.pid}").exists())
    assert plant.status == -signal.SIGKILL


def test_a_process_with_threads_is_not_copied(tmp_path: Path) -> None:
    done = threading.Event()
    other = threading.Thread(target=done.wait)
    other.start()
    try:
        with pytest.raises(RuntimeError, match="threads in the process that is to be copied: allowed is one"):
            ForkServer.of_this_process(tmp_path / "server.log")
    finally:
        done.set()
        other.join()


SAYS = """
import os, sys
from pathlib import Path
from sojourn_bringup.forked import ForkRequest, ForkServer, fork_server_for

print("begun", flush=False)
server = ForkServer.of_this_process(Path(sys.argv[1]) / "logs" / "server.log")
asked = ForkRequest(sys.argv[2], ("word",), str(Path(sys.argv[1]) / "copy.log"), {"PLACE": "here"})
ends = []
try:
    copy = server.fork(asked)
    ends.append(copy.wait(300.0))
finally:
    server.close()
print("ended with", *ends)
"""
SPOKEN = """
import os, sys
from sojourn_machine.arithmetic import outer
print(sys.argv[1:], outer(os.environ))
sys.exit("that is all")
"""


FULL = """
import sys
sys.stdout = open("/dev/full", "w")
print("there is no room for it")
"""


def copied(tmp_path: Path, program: str) -> tuple[int, str, str]:
    """Status and words of a process that has a copy of it run a program."""
    (tmp_path / "spoken.py").write_text(program, encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-c", SAYS, str(tmp_path), "spoken"],
        env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return run.returncode, run.stdout, run.stderr


def test_what_is_copied_goes_on_and_prints_nothing_twice(tmp_path: Path) -> None:
    assert copied(tmp_path, SPOKEN) == (0, "begun\nended with 1\n", "")
    assert (tmp_path / "copy.log").read_text() == "['word'] {'PLACE': 'here'}\nthat is all\n"
    assert (tmp_path / "logs" / "server.log").read_text() == ""


def test_a_copy_whose_last_words_find_no_room_ends_all_the_same(tmp_path: Path) -> None:
    """And does not go on as the process that was copied."""
    assert copied(tmp_path, FULL) == (0, "begun\nended with 0\n", "")


def test_nothing_of_ros_is_loaded_before_nodes_are_copied() -> None:
    """Its library starts threads; each node started by itself then, ten seconds of processor time for all of them."""
    program = "import sys, sojourn_bringup.start_run; print([name for name in sys.modules if name == 'rclpy'])"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


def test_where_others_have_begun_threads_each_node_starts_by_itself() -> None:
    done = threading.Event()
    plan: Any = SimpleNamespace(started=("plant", "drive", "arm"), replacements={})
    other = threading.Thread(target=done.wait)
    other.start()
    try:
        with fork_server_for(plan) as server:
            assert server is None
    finally:
        done.set()
        other.join()
