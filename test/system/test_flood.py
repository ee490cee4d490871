"""A stack under a flood of hostile messages on every topic that its nodes hear, as `measure_flood` sends them."""

import re
from collections.abc import Callable

import pytest
from programs import Program

from sojourn_contract.topic_types import ROLES

TOPICS = {"composed": 43, "processes": 51}
"""Of flat_drive; as processes in lock-step the bundles of seven roles besides, and what is said again."""
WITHOUT_LIMIT = ("--rate", "1e9", "--messages", "60000")
"""More than nodes can take: they lose messages for which all wait."""


@pytest.mark.parametrize("layout", TOPICS)
def test_it_goes_on_in_lockstep(start: Callable[..., Program], domain: int, layout: str) -> None:
    """How soon, and how many messages its nodes lose, is for the measurement to say: here the machine may be busy."""
    options = ("--messages", "10000") if layout == "composed" else ("--processes", *WITHOUT_LIMIT)
    run = start("measure_flood", "--domain", domain, *options)
    run.wait()
    assert f"{options[-1]} messages on {TOPICS[layout]} topics, {layout}" in run.text, run.text
    assert "no node has ended" in run.text, run.text
    assert re.search(r"the loop runs again after \d+\.\d\d s; its truth is finite", run.text), run.text
    refused = dict(re.findall(r"(\w+) (\d+)", *re.findall(r"^refused: (.*)$", run.text, re.MULTILINE)))
    assert refused.keys() == set(ROLES), run.text
    assert {role for role, count in refused.items() if count == "0"} <= {"operator"}, run.text
    assert int(*re.findall(r"the bag has (\d+) messages", run.text)) > 1000
