"""What the measurement of a flood says, and that it tells what is broken."""

import argparse
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.command_errors import CommandError
from sojourn_contract.stamps import CONTROL_PERIOD_NS, from_cdr
from sojourn_contract.topics import STANDARD, topic
from sojourn_studies.hostile_messages import LATEST, LONGEST_GARBAGE, MOST_CHANGES, SHORTEST, spoiled, whole
from sojourn_studies.measure_flood import record, rows_of_run
from sojourn_studies.probed_stack import add_options, probed

NOW = 40 * CONTROL_PERIOD_NS


@given(st.integers(0, 2**31), st.sampled_from(sorted(row.name for row in STANDARD)))
def test_hostile_messages_are_of_the_seed_and_no_longer_than_good_ones(seed: int, name: str) -> None:
    good = whole(topic(name))
    first, again = (spoiled(np.random.default_rng(seed), [good], NOW) for _ in range(2))
    assert first == again
    assert SHORTEST <= len(first) <= len(good)


def test_hostile_messages_are_of_all_kinds() -> None:
    good, random = whole(topic("/odom")), np.random.default_rng(7)
    assert len(good) > LONGEST_GARBAGE
    found = [spoiled(random, [good], NOW) for _ in range(2000)]
    long = [data for data in found if len(data) == len(good)]
    changed = [sum(one != other for one, other in zip(data[12:], good[12:], strict=True)) for data in long]
    timely = [data for data in long if 0 < from_cdr(data) < NOW + LATEST * CONTROL_PERIOD_NS]
    assert 0.5 < len(long) / len(found) < 0.75, "the others are cut off or no messages"
    assert min(changed) == 0 and 3 <= max(changed) <= MOST_CHANGES
    assert 0.25 < len(timely) / len(long) < 0.6


def test_the_topics_are_those_that_nodes_hear() -> None:
    names = {row.name for row in rows_of_run("flat_drive", [], bundled=False)}
    assert {"/truth/odom", "/cmd_vel", "/arm/task", "/diagnostics", "/clock", "/truth/contacts"} <= names
    bundled = {row.name for row in rows_of_run("flat_drive", [], bundled=True)}
    assert {"/_period/plant", "/_period/recorder"} <= bundled - names


def test_a_stack_that_ends_is_said_with_its_last_words(tmp_path: Path) -> None:
    parser = argparse.ArgumentParser()
    add_options(parser)
    given = parser.parse_args(["--set", "nonsense=1"])
    with probed(given, ["--composed"], (), tmp_path / "run") as stack:
        assert str(os.getpid()) not in str(stack.memory_mb())
        with pytest.raises(CommandError, match=r"^the stack has ended: .*nonsense"):
            stack.wait_for(": running")
        assert not stack.memory_mb()
        with pytest.raises(CommandError, match=r"^the bag of the flooded run: "):
            record(stack.run_dir)
