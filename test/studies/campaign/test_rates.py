"""Intervals by their definition and by what they promise, not by the formula that makes them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

from sojourn_studies.campaign.rates import rate


@given(runs=st.integers(1, 300), data=st.data())
def test_at_its_limits_what_was_seen_is_just_barely_likely(runs: int, data: st.DataObject) -> None:
    """Clopper and Pearson (1934): at the lower limit as many or more successes have a probability of 2.5 %, at the
    upper one as many or fewer.
    """
    met = data.draw(st.integers(0, runs))
    found = rate([True] * met + [False] * (runs - met))
    assert found.low <= found.share <= found.high
    assert found.low == 0.0 if met == 0 else binom.sf(met - 1, runs, found.low) == pytest.approx(0.025, rel=1e-6)
    assert found.high == 1.0 if met == runs else binom.cdf(met, runs, found.high) == pytest.approx(0.025, rel=1e-6)


@pytest.mark.parametrize("true", [0.02, 0.5, 0.9, 0.999])
def test_it_holds_the_true_rate_at_least_as_often_as_it_says(true: float) -> None:
    runs = 60
    intervals = [rate([True] * met + [False] * (runs - met)) for met in range(runs + 1)]
    held = np.array([one.low <= true <= one.high for one in intervals])
    assert binom.pmf(np.arange(runs + 1), runs, true)[held].sum() >= 0.95


def test_of_no_run_nothing_is_known() -> None:
    assert rate([])[3:] == (0.0, 1.0)
