"""However a run ends, it says why and leaves nothing behind: no process, no shared-memory file."""

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, SHORT_RUN, Program, shared_memory_files
from verdicts import require_same

from sojourn_bags.reading import read_bag

LONG = (*PATIENT, "--set", "steps=[{wait_s: 1000.0}]", "--set", "duration_limit_s=2000.0")


def is_running(text: str) -> bool:
    return "plant" in text and any(line.startswith("plant (") and ": running" in line for line in text.splitlines())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted(number: signal.Signals, start: Callable[..., Program], tmp_path: Path, domain: int) -> None:
    before = shared_memory_files()
    kind = ["--composed"] if number == signal.SIGTERM else []
    program = start("start", SHORT_RUN, *LONG, *kind, "--domain", domain, "--run-dir", tmp_path / "run")
    program.wait_until(is_running, "the run has begun")
    assert len(program.processes()) == (1 if kind else 9), "the program, what copies itself, and seven copies"
    program.send(number)
    assert program.wait() == 130
    assert "interrupted" in program.text.splitlines()[-1]
    assert not program.processes()
    assert not shared_memory_files() - before
    assert read_bag(tmp_path / "run").whole


def test_killed_node_stops_a_lockstep_run(start: Callable[..., Program], tmp_path: Path, domain: int) -> None:
    program = start("start", SHORT_RUN, *LONG, "--domain", domain, "--run-dir", tmp_path / "run")
    program.wait_until(is_running, "the run has begun")
    os.kill(program.process_of("power"), signal.SIGKILL)
    assert program.wait() == 1
    assert "power" in program.text.splitlines()[-1] and "was killed by SIGKILL" in program.text.splitlines()[-1]
    assert not program.processes()
    assert read_bag(tmp_path / "run").whole


def test_silent_node_stops_a_lockstep_run(start: Callable[..., Program], tmp_path: Path, domain: int) -> None:
    program = start(
        "start", SHORT_RUN, *LONG, "--lockstep-timeout", "10", "--domain", domain, "--run-dir", tmp_path / "run"
    )  # fmt: skip
    program.wait_until(is_running, "the run has begun")
    os.kill(program.process_of("arm"), signal.SIGSTOP)
    assert program.wait() == 1
    assert "node 'arm' did not answer" in program.text.splitlines()[-1]
    assert not program.processes()


def test_killed_supervisor_takes_its_nodes_with_it(start: Callable[..., Program], tmp_path: Path, domain: int) -> None:
    program = start("start", SHORT_RUN, *LONG, "--domain", domain, "--run-dir", tmp_path / "run")
    program.wait_until(lambda text: "plant (process" in text, "the nodes have been started")
    program.send(signal.SIGKILL)
    program.wait()
    assert not program.leaves_processes()


def test_two_namespaces_share_a_domain(start: Callable[..., Program], tmp_path: Path, domain: int) -> None:
    runs = {name: tmp_path / name for name in ("one", "two")}
    short = (*PATIENT, "--composed", "--set", "steps=[{wait_s: 1.0}]", "--domain", domain)
    programs = [start("start", SHORT_RUN, *short, "--namespace", name, "--run-dir", run) for name, run in runs.items()]
    for program in programs:
        assert program.wait() == 0, program.text
    one, two = (read_bag(run) for run in runs.values())
    require_same(one, two)
