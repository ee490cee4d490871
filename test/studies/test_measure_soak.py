"""What the measurement of a day makes of what it has seen."""

import math
from typing import Any, cast

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_studies import measure_soak
from sojourn_studies.measure_soak import EVERY_S, SUPPLIED, WAIT_S, day
from sojourn_studies.memory_growth import growth, told


def test_a_day_is_drives_to_and_fro_with_waits() -> None:
    scenario = load_scenario(SUPPLIED, day(24.0))
    drives, waits = scenario.config.steps[::2], scenario.config.steps[1::2]
    assert len(drives) == len(waits) == 24 * 3600 / EVERY_S
    assert {one.kind for one in drives} == {"drive_to"} and {one.kind for one in waits} == {"wait_s"}
    assert scenario.leaps is not None and WAIT_S < EVERY_S
    assert len(load_scenario("flat_drive", day(0.1)).config.steps) == 2


def test_what_a_supervisor_takes_to_judge_the_day_is_no_growth(monkeypatch: pytest.MonkeyPatch) -> None:
    """It read the bag for a tenth of the time, on a busy machine for more, and was said to have grown by 3 %."""
    monkeypatch.setattr(measure_soak, "LOOK_S", 0.0)
    day = [{"1 start": 290.0, "2 plant": 240.0}] * 20
    left = iter([*day, *[{"1 start": 415.0}] * 30])
    sample = next(left)

    class Stack:
        """One whose nodes end, and whose supervisor goes on for a while."""

        runs = True

        def wait_for(self, words: str) -> None:
            """It runs."""

        def memory_mb(self) -> dict[str, float]:
            """The next sample."""
            nonlocal sample
            here, sample = sample, next(left, {})
            self.runs = bool(sample)
            return here

    assert measure_soak.soak(cast(Any, Stack())) == day


def test_growth_is_of_what_follows_once_buffers_are_full() -> None:
    assert growth([100.0, 200.0, *[300.0] * 18]) == 0.0
    assert growth([300.0 + number for number in range(20)]) == pytest.approx(12 / 305.5)
    assert math.isnan(growth([1.0, 2.0]))
    lines = list(told([{"7 plant": 100.0 + number, "8 drive": 50.0} for number in range(10)]))
    assert lines == [
        "7 plant: 100 MB at first, 109 MB at last, +5.9 % from the second fifth to the last",
        "8 drive: 50 MB at first, 50 MB at last, +0.0 % from the second fifth to the last",
    ]
