"""What Linux tells of a process."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sojourn_bringup.child import Child
from sojourn_bringup.process_state import is_stopped, memory_mb


@pytest.fixture
def child(tmp_path: Path) -> Iterator[Child]:
    """A process that waits."""
    started = Child.of_command("operator", ["sleep", "1000"], os.environ, tmp_path / "log")
    yield started
    started.send(signal.SIGKILL)
    assert started.wait(10.0)


def test_a_process_holds_memory_and_can_be_stopped(child: Child) -> None:
    assert 0.0 < child.memory_mb() < memory_mb() == memory_mb(os.getpid())
    assert not is_stopped(child.pid)
    child.send(signal.SIGSTOP)
    os.waitid(os.P_PID, child.pid, os.WSTOPPED | os.WNOWAIT)
    assert is_stopped(child.pid)
    assert child.is_stopped


def test_of_one_that_has_ended_nothing_is_told() -> None:
    ended = subprocess.Popen(["true"])
    ended.wait()
    with pytest.raises(OSError):
        memory_mb(ended.pid)
    with pytest.raises(OSError):
        is_stopped(ended.pid)


def test_asking_leaves_no_names_behind(child: Child, monkeypatch: pytest.MonkeyPatch) -> None:
    """A supervisor asked through a day, and grew by 10 MB: what Python keeps names in does, where they come and go."""
    kept: list[str] = []
    monkeypatch.setattr(sys, "intern", lambda name: kept.append(name) or name)
    child.memory_mb()
    assert not child.is_stopped
    assert not kept
