"""Slip of a drive in the plant that hears only some of its readings, as on a busy machine in real time."""

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_flight.mobility import rolling
from sojourn_flight.odometry.slip_correction import no_headway
from sojourn_flight.odometry.slip_estimation import SlipInput, SlipModel, SlipState
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive import LONGEST_PERIOD
from sojourn_machine.params import FloatArray
from sojourn_studies.closed_loop import ClosedLoop

GOALS = ((0.12, 250), (0.32, 250), (0.42, 250), (0.7, 500), (1.6, 1000))
"""Where to along x [m], and how many periods later the next one comes: standing, rocking, or still on its way."""


class Drive(NamedTuple):
    """What the slip was estimated from."""

    model: SlipModel
    readings: list[SlipInput]


class Found(NamedTuple):
    """The estimate, period by period; NaN where there was none."""

    slip: FloatArray
    sigma: FloatArray
    trouble: str


@pytest.fixture(scope="module")
def drive() -> Drive:
    """A rover that drives, stops and drives again on level ground that yields."""
    estimate, readings, models = rolling.estimate_slip, [], []

    def noted(model: SlipModel, state: SlipState, measured: SlipInput, dt: float) -> SlipState:
        models[:] = [model]
        readings.append(measured)
        return estimate(model, state, measured, dt)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rolling, "estimate_slip", noted)
        loop = ClosedLoop(load_scenario("flat_drive"))
        for _ in range(200):
            loop.step()
        for x, periods in GOALS:
            loop.step(goal=Goal.at(x, 0.0))
            for _ in range(periods - 1):
                loop.step()
    return Drive(models[0], readings)


def found(drive: Drive, heard: NDArray[np.bool_]) -> Found:
    """The estimate from the readings that are heard."""
    state, slip, sigma = drive.model.initial_state(), np.full(len(heard), np.nan), np.full(len(heard), np.nan)
    names, trouble, since = tuple("abcdef"), "", 0.0
    for index, reading in enumerate(drive.readings):
        since += CONTROL_PERIOD_S
        if not heard[index]:
            continue
        state, since = rolling.estimate_slip(drive.model, state, reading, min(since, LONGEST_PERIOD)), 0.0
        trouble = trouble or no_headway(drive.model, state, 0.0, names)
        if state.observable:
            slip[index], sigma[index] = state.shared, state.sigma
    return Found(slip, sigma, trouble)


def with_gaps(count: int, mean: int, seed: int) -> NDArray[np.bool_]:
    """Which readings are heard: runs and gaps, each of a length by chance with this mean."""
    random, heard = np.random.default_rng(seed), np.ones(count, dtype=np.bool_)
    begin = 0
    while begin < count:
        begin += 1 + random.geometric(1.0 / mean)
        end = begin + random.geometric(1.0 / mean)
        heard[begin:end] = False
        begin = end
    return heard


@pytest.mark.parametrize("mean", [5, 15, 40, 100])
def test_gaps_make_the_slip_doubtful_but_not_wrong(mean: int, drive: Drive) -> None:
    """A tilt rate was held for all of a gap, and a gap at whose end the wheels stood was taken for a stand: a speed off
    by several times its doubt, and now and then wheels that "spin without headway" before a goal 0.1 m away.
    """
    count = len(drive.readings)
    whole = found(drive, np.ones(count, dtype=np.bool_))
    assert not whole.trouble
    beyond = []
    for seed in range(40):
        heard = with_gaps(count, mean, seed)
        some = found(drive, heard)
        assert not some.trouble, f"seed {seed}: {some.trouble}"
        both = np.isfinite(some.slip) & np.isfinite(whole.slip)
        off = np.abs(some.slip - whole.slip)[both]
        beyond.append((off > 3.0 * np.hypot(some.sigma, whole.sigma)[both]).mean())
    assert np.mean(beyond) < 0.003
