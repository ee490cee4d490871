"""The error that each soil reaches on measured trials, pinned: a change of the model that makes one worse fails here.

Medians of |error| over the load for forces, over the radius for the sinkage. The last column is what was asked of the
model, the one before it what it reaches.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sojourn_analysis.wheels.test_bed import GRAVITY
from sojourn_analysis.wheels.trials import Trials, predict, summary
from sojourn_config.load import load_params
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams, kernel_row
from sojourn_studies.trial_file import read_rows, read_trials, select

MEASURED = Path(__file__).parent / "measured"
SMOOTH = MEASURED / "wheel_tests_smooth.csv"
DING_KLS1 = MEASURED / "wheel_tests_ding_kls1.csv"
# part, quantity, pinned [%], target [%]
PINNED = {
    "cmu_sand": (
        ("driving", "drawbar_pull", 1.68, 3.0),
        ("driving", "side_force", 2.15, 3.0),
        ("driving", "sinkage", 1.94, 3.0),
        ("all", "drawbar_pull", 5.83, 7.0),
        ("all", "side_force", 5.55, 7.0),
        ("all", "sinkage", 3.47, 7.0),
    ),
    "ding_2011": (("all", "drawbar_pull", 3.80, 6.0), ("all", "sinkage", 1.90, 4.0), ("all", "torque", 5.50, None)),
    "kls_1": (("all", "drawbar_pull", 4.05, 8.0), ("all", "sinkage", 1.00, 8.0), ("all", "torque", 20.0, None)),
}


def trials_of(soil: str) -> Trials:
    if soil == "cmu_sand":
        return read_trials(SMOOTH, read_rows(SMOOTH), load_params("wheels", "pavlov_smooth", WheelShape), GRAVITY)
    simulant = {"ding_2011": "Ding2011_planetary_simulant", "kls_1": "KLS-1"}[soil]
    return read_trials(DING_KLS1, select(read_rows(DING_KLS1), [f"soil_simulant={simulant}"]), None, GRAVITY)


def predicted(soil: str, trials: Trials) -> np.ndarray:
    return predict(trials, kernel_row(load_params("soils", soil, SoilParams)))


@pytest.mark.published
@pytest.mark.parametrize("soil", PINNED)
def test_error_reached_on_the_trials(soil: str, record_property: Callable[[str, object], None]) -> None:
    trials = trials_of(soil)
    reached = summary(trials, predicted(soil, trials))
    assert reached["all"]["not_carried"] == 0
    for part, quantity, pinned, target in PINNED[soil]:
        error = reached[part][f"{quantity}_error_percent"]
        assert error is not None
        asked = "" if target is None else f" ({target:g} % asked)"
        record_property(f"{soil}, trials {part}: median error of {quantity}", f"{error:.2f} %{asked}")
        assert error <= pinned, f"{soil}, {part}: {quantity} {error:.2f} %"
        assert target is None or pinned <= target


def test_torque_on_kls_1_is_off_by_a_constant() -> None:
    """As config/soils/kls_1.yaml says: friction in the drive, no error that grows with the slip."""
    trials = trials_of("kls_1")
    missing = trials.measured[:, 3] - predicted("kls_1", trials)[:, 3]
    assert missing.mean() == pytest.approx(0.96, abs=0.03)
    load_times_radius = trials.cases[:, 0] * trials.shapes[:, 0]
    assert np.median(np.abs(missing - missing.mean()) / load_times_radius) < 0.02


def test_the_files_are_whole() -> None:
    assert len(trials_of("cmu_sand").cases) == 189
    assert int(trials_of("cmu_sand").driving().sum()) == 60
    assert len(trials_of("ding_2011").cases) == 6 and len(trials_of("kls_1").cases) == 5


def test_trends_that_the_trials_show() -> None:
    """What a median error does not see: deeper with slip, skid and sideslip; a force against the sideslip."""
    trials = trials_of("cmu_sand")
    found = predicted("cmu_sand", trials)
    slip, angle = trials.cases[:, 1], np.degrees(trials.cases[:, 2])

    def mean(column: int, s: float, beta: float) -> float:
        return float(found[(np.abs(slip - s) < 0.01) & (np.abs(angle - beta) < 0.1), column].mean())

    for beta in (0.0, 15.0, 30.0, 45.0):
        assert mean(2, 0.9, beta) > mean(2, 0.0, beta)
        assert mean(2, -1.0, beta) > 1.5 * mean(2, 0.0, beta)
        assert mean(0, -1.0, beta) < mean(0, -0.5, beta) < mean(0, 0.0, beta) < mean(0, 0.5, beta)
    side = [mean(1, 0.0, beta) for beta in (15.0, 30.0, 45.0, 60.0, 75.0, 90.0)]
    assert side == sorted(side, reverse=True) and side[0] < 0.0
    assert mean(0, 0.9, 90.0) > 0.0  # the turning face pulls the wheel along
