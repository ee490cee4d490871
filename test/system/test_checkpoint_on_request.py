"""A checkpoint asked of a running stack, by whoever operates it."""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, Program

from sojourn_stack.checkpoint import read

REST = ("flat_drive", *PATIENT, "--composed", "--without", "arm", "--set", "steps=[{wait_s: 3000.0}]")


@pytest.mark.parametrize(
    ("kept", "words"), [(True, "the state of "), (False, "no running stack for checkpoints on domain")]
)
def test_it_is_kept_by_a_run_that_keeps_them_and_by_no_other(
    start: Callable[..., Program], domain: int, tmp_path: Path, kept: bool, words: str
) -> None:
    every = ("--checkpoint-every", "100000") if kept else ()
    run = start("start", *REST, *every, "--domain", domain, "--run-dir", tmp_path / "run")
    run.wait_until(lambda text: "): running" in text, "the run begins")
    asked = start("checkpoint_client", "--domain", domain, "--timeout", "600")
    assert asked.wait() == (0 if kept else 1), asked.text
    assert words in asked.text
    run.send(signal.SIGINT)
    run.wait()
    files = list((tmp_path / "run" / "checkpoints").glob("*"))
    assert len(files) == kept
    for file in files:
        state, origin = read(file)
        assert f"the state of {state.now / 1e9:.2f} s is kept" in asked.text
        assert origin is not None and "arm" not in origin.participants
