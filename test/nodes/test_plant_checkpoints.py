"""The plant of a run that keeps checkpoints: it asks for no states before the last ones are in a file."""

from collections.abc import Callable
from typing import Any

import pytest
from node_bench import Bench

from sojourn_contract.checkpoint_topic import FILED, STATE
from sojourn_contract.codecs import encode
from sojourn_contract.handing_over import reader, sender
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.values import DiagnosticArray, Header
from sojourn_plant.node import PlantNode

EVERY = 2
"""Control periods from one checkpoint to the next; the recorder, who alone is with the plant, may lag by 25."""


@pytest.fixture
def run(bench: Bench, quick_start: None) -> Callable[..., tuple[PlantNode, list[int]]]:
    """Starts a plant, and gives it with the periods of which it hands over its state."""

    def start(timeout_s: float = 600.0) -> tuple[PlantNode, list[int]]:
        every_s = EVERY * CONTROL_PERIOD_NS / 1e9
        plant = bench.start(
            PlantNode, "plant", "recorder", checkpoint_every_s=every_s, lockstep_timeout_s=float(timeout_s)
        )
        kept: list[int] = []

        def hear(message: DiagnosticArray) -> None:
            kept.extend(beat.stamp // CONTROL_PERIOD_NS for beat in read_heartbeats(message) if beat.role == "plant")

        reader(bench.peer, STATE, hear)
        bench.connect(plant)
        bench.say_ready("recorder")
        return plant, kept

    return start


def test_it_goes_on_to_the_next_once_the_last_is_in_a_file(bench: Bench, run: Callable[..., Any]) -> None:
    writer = sender(bench.peer, FILED)
    plant, kept = run()
    for number in range(1, 6):
        before = (EVERY * (number + 1) - 1) * CONTROL_PERIOD_NS
        bench.until(lambda before=before: plant.now == before, "the plant is before the next one")  # type: ignore[misc]
        bench.until(lambda number=number: len(kept) == number, "a state")  # type: ignore[misc]
        for _ in range(20):
            bench.executor.spin_once(timeout_sec=0.01)
            plant.poll()
        assert kept == [EVERY * (one + 1) for one in range(number)]
        writer.publish(encode(FILED, Header(plant.now)))  # of another period
        writer.publish(encode(FILED, Header(kept[-1] * CONTROL_PERIOD_NS)))


def test_it_does_not_wait_where_nobody_writes(bench: Bench, run: Callable[..., Any]) -> None:
    _, kept = run()
    bench.until(lambda: len(kept) >= 5, "states")
    assert kept[:5] == [2, 4, 6, 8, 10]


def test_it_waits_once_for_a_writer_that_does_nothing(bench: Bench, run: Callable[..., Any]) -> None:
    sender(bench.peer, FILED)
    plant, kept = run(timeout_s=2.0)
    bench.until(lambda: len(kept) >= 5, "states")
    assert kept[:5] == [2, 4, 6, 8, 10] and not plant.failure
