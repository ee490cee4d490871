"""The measurement of the odometry over seeds: what one that cannot be driven leaves of the others."""

from collections.abc import Sequence

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_studies import measure_odometry
from sojourn_studies.measure_odometry import SeedResult

RESULT = SeedResult(1, 30.0, 0.3, 1.0, 0.001, 0.002, 0.1, "reached")


def driven_but_the_second(name: str, overrides: Sequence[str], seed: int) -> SeedResult:
    if seed == 2:
        raise UsageError(f"scenario {name}, seed {seed}: at rest 0.4 m off")
    return RESULT._replace(seed=seed)


def driven_outside_of_its_bound(name: str, overrides: Sequence[str], seed: int) -> SeedResult:
    return RESULT._replace(seed=seed, squared=9.0)


def test_a_seed_that_cannot_be_driven_is_told_and_the_others_are_measured(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """They were lost with it."""
    monkeypatch.setattr(measure_odometry, "drive", driven_but_the_second)
    assert measure_odometry.main(["--scenario", "lunar_route", "--seeds", "3"]) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("seed   1: reached, 30.00 m, error 0.300 m (1.00 %), 1.00 sigma")
    assert said[1] == "scenario lunar_route, seed 2: at rest 0.4 m off"
    assert said[2].startswith("seed   3") and said[3] == "not driven: 1 of 3 seeds"
    assert said[-1] == "inside the stated 95 % ellipse: 2 of 2"
    assert measure_odometry.main(["--scenario", "lunar_route", "--seeds", "1"]) == 0
    assert measure_odometry.main(["--scenario", "lunar_route", "--seeds", "1", "--first", "2"]) == 1


def test_a_bound_that_is_not_kept_is_the_status(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure_odometry, "drive", driven_outside_of_its_bound)
    assert measure_odometry.main(["--scenario", "lunar_route", "--seeds", "2"]) == 1


def test_a_scenario_without_a_route_is_refused_before_any_seed_is_driven() -> None:
    with pytest.raises(UsageError, match="no step drives a route"):
        measure_odometry.main(["--scenario", "flat_drive", "--seeds", "2"])
