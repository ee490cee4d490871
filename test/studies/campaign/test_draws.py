"""What each run is: a function of the campaign and of its number."""

from typing import Any

import numpy as np
import pytest

from sojourn_studies.campaign.campaign_file import CampaignConfig
from sojourn_studies.campaign.draws import draws, shares


def config(**changed: Any) -> CampaignConfig:
    values = {
        "soil.n": {"kind": "uniform", "low": 0.0, "high": 1.0},
        "battery_soc": {"kind": "uniform", "low": 0, "high": 1},
    }
    return CampaignConfig(**{"description": "x", "scenario": "flat_drive", "runs": 16, "values": values, **changed})


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_more_runs_leave_the_first_ones_as_they_are(sampling: str) -> None:
    few, many = draws(config(sampling=sampling)), draws(config(sampling=sampling, runs=50))
    assert few == many[:16]
    assert draws(config(sampling=sampling, seed=2)) != few


def test_a_further_key_leaves_random_draws_of_the_others_as_they_are() -> None:
    before = draws(config())
    values = {**config().model_dump()["values"], "a.b": {"kind": "normal", "mean": 0.0, "deviation": 1.0}}
    after = draws(config(values=values))
    assert [one.values["soil.n"] for one in before] == [one.values["soil.n"] for one in after]
    assert [one.values["seed"] for one in before] == [one.values["seed"] for one in after]


def test_latin_hypercube_meets_every_share_once() -> None:
    cube = shares("latin_hypercube", 5, 40, ["a", "b", "c"])
    for column in range(3):
        assert sorted(np.floor(40 * cube[:, column]).astype(int)) == list(range(40))


def test_sobol_is_more_even_than_chance() -> None:
    """In each of the 64 boxes of 8 by 8 there is one of 64 points."""
    cube = shares("sobol", 5, 64, ["a", "b"])
    boxes = np.floor(8 * cube).astype(int)
    assert len({tuple(box) for box in boxes}) == 64


def test_grids_give_every_combination_and_lists_run_side_by_side() -> None:
    values = {
        "machine": {"kind": "grid", "of": ["a", "b"]},
        "soil": {"kind": "grid", "of": ["p", "q", "r"]},
        "start.x": {"kind": "list", "of": [1, 2]},
        "start.y": {"kind": "list", "of": [10, 20]},
    }
    runs = draws(config(values=values, runs=None))
    places = [(one.values["machine"], one.values["soil"], one.values["start.x"]) for one in runs]
    assert len(places) == 12 and len(set(places)) == 12
    assert all(one.values["start.y"] == 10 * one.values["start.x"] for one in runs)
    again = draws(config(values=values, runs=24))
    assert [one.values["soil"] for one in again[12:]] == [one.values["soil"] for one in again[:12]]
    assert again[12].values["seed"] != again[0].values["seed"]


def test_every_run_has_a_seed_of_its_own_unless_the_campaign_says_one() -> None:
    assert len({one.values["seed"] for one in draws(config())}) == 16
    assert all("seed=5" in one.overrides for one in draws(config(set={"seed": 5})))


def test_values_become_texts_of_set() -> None:
    values = {
        "faults": {"kind": "list", "of": [[], [{"joint": "x", "at_s": 1.5}]]},
        "scenario": {"kind": "list", "of": ["a", "b"]},
    }
    one, two = draws(config(values=values, scenario=None, runs=None, set={"seed": 1}))
    assert one.scenario == "a" and two.scenario == "b"
    assert one.overrides == ("seed=1", "faults=[]")
    assert two.overrides == ("seed=1", 'faults=[{"joint": "x", "at_s": 1.5}]')


def test_about_the_share_asked_for_is_kept() -> None:
    kept = sum(one.sampled for one in draws(config(runs=1000, keep={"sample": 0.1})))
    assert 70 <= kept <= 130
    assert not any(one.sampled for one in draws(config()))
