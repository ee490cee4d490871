"""A checkpoint asked of a running stack, by whoever operates it, and the run that goes on from it."""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, Program

from sojourn_bags.reading import read_bag
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


@pytest.mark.parametrize("layout", ["--composed", "--processes"])
def test_what_goes_on_from_it_is_the_run(
    start: Callable[..., Program], domain: int, tmp_path: Path, layout: str
) -> None:
    """What became of a request was in the heartbeats of the unbroken run alone, and so were those that are refused."""
    rest = [layout if word == "--composed" else word for word in REST]
    run = start("start", *rest, "--checkpoint-every", "100000", "--domain", domain, "--run-dir", tmp_path / "run")
    run.wait_until(lambda text: "): running" in text, "the run begins")
    answers: list[str] = []
    while sum("is kept" in text for text in answers) < 2:
        asked = start("checkpoint_client", "--domain", domain, "--timeout", "600")
        asked.wait()
        answers.append(asked.text)
    run.send(signal.SIGINT)
    run.wait()
    first, second = sorted((tmp_path / "run" / "checkpoints").glob("*"))
    begin, end = (read(file)[0].now for file in (first, second))
    limit = ("--set", f"duration_limit_s={end / 1e9 + 1.0}")
    start("start", "--resume", first, *limit, "--run-dir", tmp_path / "rest").wait()
    unbroken, rest_of_it = (
        {
            name: [(at, data) for at, data in zip(one.log_times, one.data, strict=True) if begin < at < end]
            for name, one in read_bag(tmp_path / folder).topics.items()
        }
        for folder in ("run", "rest")
    )
    assert {name: said for name, said in unbroken.items() if said} == rest_of_it
    assert len(rest_of_it["/diagnostics"]) > 20
