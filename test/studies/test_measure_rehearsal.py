"""How a rehearsal is judged: which goals are tried, what is foretold and taken, and what counts."""

import argparse
import itertools
import math
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_console.rehearsed import RECKONED, RehearsedDrive
from sojourn_studies import measure_rehearsal
from sojourn_studies.measure_rehearsal import FAR_M, Trial, goals, in_words, main, tried

DRIVE = RehearsedDrive(RECKONED, "reached", time_s=100.0, length_m=10.2, energy_wh=4.0, is_over=True)
SHORT = argparse.Namespace(scenario="flat_drive", machine=None, set=[], drives=1, first=1)


def trial(answer_s: float = 2.0, time_s: float = 100.0, energy_wh: float = 4.0, state: str = "reached") -> Trial:
    taken = RehearsedDrive(state=state, time_s=time_s, length_m=10.0, energy_wh=energy_wh)
    return Trial(DRIVE, answer_s, replace(DRIVE, look=1, time_s=99.0), taken)


def test_goals_lie_on_the_map_in_other_directions_for_each_seed() -> None:
    loaded = load_scenario("flat_drive", ["start={x: -6, y: 2}"])
    x_min, x_max, y_min, y_max = loaded.height_field().bounds
    ways = [
        [draft.points[0][:2] for draft, _ in itertools.islice(goals("flat_drive", loaded, seed), 5)] for seed in (1, 2)
    ]
    for x, y in itertools.chain.from_iterable(ways):
        assert x_min <= x <= x_max and y_min <= y <= y_max
        assert math.dist((x, y), (-6.0, 2.0)) == pytest.approx(FAR_M)
    assert not set(ways[0]) & set(ways[1])


def test_a_drive_is_foretold_and_then_driven_on_other_soil(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure_rehearsal, "FAR_M", 0.6)
    found = tried(SHORT, 4)
    assert found.first.state == found.last.state == found.taken.state == "reached" and found.answer_s > 0.0
    assert 0.5 < found.taken.length_m < 1.0
    assert abs(found.off(found.first)[0]) < 0.5, "the time for which it stood before is no part of the drive"
    assert found.taken.energy_wh != found.first.energy_wh


@pytest.mark.parametrize(
    ("one", "holds"),
    [
        (trial(), True),
        (trial(time_s=92.0, energy_wh=4.3), True),
        (trial(time_s=89.0), False),
        (trial(energy_wh=4.5), False),
        (trial(state="stopped"), False),
        (trial(time_s=0.0, energy_wh=0.0, state="refused"), False),
    ],
)
def test_a_drive_is_near_that_ends_as_foretold_within_a_tenth(one: Trial, holds: bool) -> None:
    assert one.is_near(one.first) is holds


def test_one_drive_that_was_not_foretold_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    class Standing:
        def wait_for(self, _pattern: str) -> None: ...
        def require_running(self) -> None: ...

    monkeypatch.setattr(measure_rehearsal, "probed", lambda *_: nullcontext(Standing()))
    monkeypatch.setattr(measure_rehearsal, "tried", lambda _given, seed: trial(energy_wh=5.0 if seed == 8 else 4.0))
    assert main(["--drives", "2", "--first", "7"]) == 1
    said = capsys.readouterr().out
    assert "energy by 20.0 % at most" in said and "1 of 2 first answers, 1 of the last" in said
    assert main(["--drives", "1", "--first", "7"]) == 0
    monkeypatch.setattr(measure_rehearsal, "tried", lambda _given, _seed: trial(answer_s=3.1))
    assert main(["--drives", "1"]) == 1, "it came too late"
    assert in_words(7, trial()) == (
        "seed   7: took 10.00 m, 100.0 s, 4.00 Wh (reached); answered after 2.00 s: 100.0 s (+0.0 %), 4.00 Wh "
        "(+0.0 %), reached; at last 99.0 s (-1.0 %), 4.00 Wh (+0.0 %), reached"
    )
