"""A stack under a flood of hostile messages on every topic that its nodes hear, as `measure_flood` sends them."""

import re
from collections.abc import Callable

import pytest
from programs import Program

TOPICS = {"composed": 43, "processes": 50}
"""Of flat_drive; as processes in lock-step the bundles of seven roles besides."""


@pytest.mark.parametrize("layout", TOPICS)
def test_it_goes_on_in_lockstep(start: Callable[..., Program], domain: int, layout: str) -> None:
    """How soon, that is for the measurement to say: here the machine may be busy."""
    options = ("--messages", 10_000, "--domain", domain, *(["--processes"] if layout == "processes" else []))
    run = start("measure_flood", *options)
    run.wait()
    assert f"10000 messages on {TOPICS[layout]} topics, {layout}" in run.text, run.text
    assert "no node has ended" in run.text, run.text
    assert re.search(r"the loop runs again after \d+\.\d\d s; its truth is finite", run.text), run.text
    refused, recorded = map(int, re.findall(r"refused by the nodes: (\d+); the bag has (\d+) messages", run.text)[0])
    assert refused > 1000 and recorded > 1000
