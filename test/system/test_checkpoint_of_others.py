"""A node that is not ours takes part in checkpoints by two topics, or the run is said not to be resumable."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import Program
from test_flight_drive import COMMAND

from sojourn_bags.comparison import compare
from sojourn_bags.reading import read_bag
from sojourn_contract.role_state import ForeignState
from sojourn_stack.checkpoint import read

REST = ("flat_drive", "--without", "arm", "--start-timeout", "600")
STEPS = "steps=[{drive_to: {x: -0.8, y: 0.1}}]"
RESUMABLE = f"drive={COMMAND} --start -1 0 0 --resumable"


@pytest.fixture
def kept(tmp_path: Path, start: Callable[..., Program], domain: int) -> Path:
    """Folder of a run with a drive of others, which hands over its state."""
    options = ("--set", STEPS, "--replace", RESUMABLE, "--checkpoint-every", "2")
    given = (*REST, *options, "--lockstep-timeout", "300", "--domain", domain, "--run-dir", tmp_path / "run")
    run = start("start", *given)
    assert run.wait() == 0, run.text
    return tmp_path / "run"


def test_what_goes_on_with_it_is_the_run(
    kept: Path, tmp_path: Path, start: Callable[..., Program], domain: int
) -> None:
    unbroken, file = read_bag(kept), kept / "checkpoints" / "00004.00.checkpoint"
    state, _ = read(file)
    assert isinstance(state.roles["drive"].app, ForeignState)
    ours = start("start", "--resume", file, "--run-dir", tmp_path / "ours")
    assert ours.wait() == 2, ours.text
    assert "it has the state of a drive of others: allowed is --processes --replace drive=COMMAND with it" in ours.text
    options = ("--processes", "--replace", RESUMABLE, "--start-timeout", "600", "--lockstep-timeout", "300")
    rest = start("start", "--resume", file, *options, "--domain", domain, "--run-dir", tmp_path / "rest")
    assert rest.wait() == 0, rest.text
    for messages in unbroken.topics.values():
        messages.take_out({n for n, at in enumerate(messages.log_times) if at <= state.now})
    later = {name: messages for name, messages in unbroken.topics.items() if len(messages)}
    bag = read_bag(tmp_path / "rest")
    for topic in compare(later, bag.topics).topics:
        assert topic.matched == topic.one == topic.other and not topic.fields, topic
    assert len(bag["/drive_command"].times) > 100
    assert bag.records["sojourn_completeness"]["gaps"] == ""


def test_one_that_hands_over_nothing_is_named(tmp_path: Path, start: Callable[..., Program], domain: int) -> None:
    options = ("--set", "steps=[{wait_s: 3.0}]", "--replace", f"drive={COMMAND}", "--checkpoint-every", "1")
    given = (*REST, *options, "--lockstep-timeout", "60", "--domain", domain, "--run-dir", tmp_path / "run")
    run = start("start", *given)
    assert run.wait() == 0, run.text
    (said,) = re.findall(r"^this run is not resumable.*$", run.text, re.MULTILINE)
    assert said.endswith("drive has not handed over its state on /checkpoint/state")
    assert not (tmp_path / "run" / "checkpoints").exists()
