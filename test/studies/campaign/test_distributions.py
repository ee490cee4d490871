"""Distributions against scipy's, which are made another way."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy import stats

from sojourn_studies.campaign.distributions import (
    ChoiceParams,
    Distribution,
    IntegersParams,
    LogNormalParams,
    LogUniformParams,
    NormalParams,
    UniformParams,
)

LIMITED = NormalParams(kind="normal", mean=2.0, deviation=0.5, low=1.9, high=3.5)
KINDS = [
    (UniformParams(kind="uniform", low=-3.0, high=5.0), stats.uniform(-3.0, 8.0)),
    (LogUniformParams(kind="log_uniform", low=0.01, high=100.0), stats.loguniform(0.01, 100.0)),
    (NormalParams(kind="normal", mean=2.0, deviation=0.5), stats.norm(2.0, 0.5)),
    (LIMITED, stats.truncnorm((1.9 - 2.0) / 0.5, (3.5 - 2.0) / 0.5, 2.0, 0.5)),
    (LogNormalParams(kind="log_normal", median=8e5, factor=2.0), stats.lognorm(np.log(2.0), scale=8e5)),
]


@pytest.mark.parametrize(("ours", "reference"), KINDS)
@given(share=st.floats(1e-9, 1.0 - 1e-9))
def test_the_share_of_draws_below_a_quantile_is_as_asked(ours: Distribution, reference: Any, share: float) -> None:
    assert reference.cdf(ours.quantile(share)) == pytest.approx(share, abs=2e-8)


@given(low=st.integers(-50, 50), more=st.integers(0, 60))
def test_whole_numbers_come_equally_often(low: int, more: int) -> None:
    one = IntegersParams(kind="integers", low=low, high=low + more)
    middles = [(place + 0.5) / (more + 1) for place in range(more + 1)]
    assert [one.quantile(share) for share in middles] == list(range(low, low + more + 1))
    assert one.quantile(1e-12) == low and one.quantile(1.0 - 1e-12) == low + more


def test_a_choice_keeps_to_its_weights_and_never_takes_what_weighs_nothing() -> None:
    one = ChoiceParams(kind="choice", of=("a", [1], None), weights=(1.0, 3.0, 0.0))
    drawn = [str(one.quantile((number + 0.5) / 1000)) for number in range(1000)]
    assert drawn.count("a") == 250 and drawn.count("[1]") == 750
    assert one.quantile(1.0 - 1e-15) == [1]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: UniformParams(kind="uniform", low=1.0, high=1.0), "above low, 1"),
        (lambda: NormalParams(kind="normal", mean=0.0, deviation=1.0, low=9.0), "leave more than"),
        (lambda: NormalParams(kind="normal", mean=0.0, deviation=0.0), "greater than 0"),
        (lambda: LogNormalParams(kind="log_normal", median=1.0, factor=1e200), "less than or equal to 10"),
        (lambda: ChoiceParams(kind="choice", of=()), "at least 1 item"),
        (lambda: ChoiceParams(kind="choice", of=(1, 2), weights=(0.0, 0.0)), "one of them above 0"),
        (lambda: IntegersParams(kind="integers", low=3, high=2), "at least low, 3"),
        (lambda: UniformParams(kind="uniform", low=0.0, high=float("inf")), "finite"),
    ],
)
def test_what_nothing_can_be_drawn_from_is_refused(make: Callable[[], Distribution], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        make()
