"""How often a page is shown on machines on which scenes cost little, and on those on which they cost much."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from told_feed import ToldFeed

import sojourn_console.page as page_module
from sojourn_bags.provenance import RUN_NAME
from sojourn_bags.reading import Bag
from sojourn_console import world as world_module
from sojourn_console.frames import FEWEST, FRAMES, PART, REALTIME_PART, SMOOTHED, Frames
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.world import World, world_of_run


@given(st.floats(0.0, 1.0), st.integers(1, 64))
def test_scenes_take_no_more_of_the_processors_than_they_may(cost: float, processors: int) -> None:
    """Or are the fewest that a page must have."""
    frames = Frames(PART * processors)
    for _ in range(20 * SMOOTHED):
        interval = frames.interval_s(cost)
    assert 1.0 / FRAMES <= interval <= 1.0 / FEWEST
    assert cost / interval <= PART * processors * (1.0 + 1e-6) or interval == 1.0 / FEWEST
    assert interval == 1.0 / FRAMES or cost / interval >= PART * processors * (1.0 - 1e-6)


def test_one_scene_that_costs_much_does_not_hold_up_the_next() -> None:
    frames = Frames(0.1)
    assert [frames.interval_s(0.003) for _ in range(10)] == [1.0 / FRAMES] * 10
    assert frames.interval_s(0.3) == 1.0 / FEWEST
    after = [frames.interval_s(0.002) for _ in range(3 * SMOOTHED)]
    assert sum(after) < 2 * 3 * SMOOTHED / FRAMES and after[-1] == pytest.approx(1.0 / FRAMES)


@pytest.mark.parametrize(("lockstep", "is_so"), [("true", False), ("false", True), (None, False)])
def test_a_run_that_goes_by_the_wall_clock_is_known_by_its_bag(
    reference: Bag, monkeypatch: pytest.MonkeyPatch, lockstep: str | None, is_so: bool
) -> None:
    """One that does not say so is taken for one in lock-step, from which less is taken."""
    said = {} if lockstep is None else {RUN_NAME: json.dumps({"participants": "plant", "lockstep": lockstep}).encode()}
    others = {name: data for name, data in reference.attachments.items() if name != RUN_NAME}
    files = replace(world_module.recorded_run(reference.path), attachments={**others, **said})
    monkeypatch.setattr(world_module, "recorded_run", lambda _folder: files)
    assert world_of_run(reference.path).is_in_real_time is is_so


@pytest.mark.parametrize(("is_in_real_time", "part"), [(True, REALTIME_PART), (False, PART)])
def test_a_run_in_lock_step_is_left_more_of_the_processors(
    world: World, monkeypatch: pytest.MonkeyPatch, is_in_real_time: bool, part: float
) -> None:
    asked = list[float]()

    def frames(processors: float) -> Frames:
        asked.append(processors)
        return Frames(processors)

    monkeypatch.setattr(page_module, "Frames", frames)
    monkeypatch.setattr(page_module.os, "sched_getaffinity", lambda _process: range(4))
    page = Page(GuardedServer("frames", 9150), replace(world, is_in_real_time=is_in_real_time), ToldFeed(world.table))
    try:
        page.run(lambda: False)
    finally:
        page.close()
    assert asked == [4 * part]
