"""Sensitivity on functions whose indices are known in closed form."""

import numpy as np
import pytest
from scipy import stats

from sojourn_studies.campaign.sensitivity import classes_of, first_order, is_numeric, rank_correlation


def ishigami(x: np.ndarray) -> np.ndarray:
    """Ishigami and Homma (1990), a = 7, b = 0.1: rises, falls, and interacts."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


@pytest.mark.published
def test_indices_of_ishigami_are_the_published_ones() -> None:
    """0.3139, 0.4424, 0 (Saltelli et al. 2008, Global Sensitivity Analysis: The Primer, 5.8)."""
    x = np.random.default_rng(1).uniform(-np.pi, np.pi, (8000, 3))
    y = ishigami(x)
    for column, expected in enumerate((0.3139, 0.4424, 0.0)):
        found = first_order(classes_of(x[:, column].tolist()), y)
        assert found is not None and found.value == pytest.approx(expected, abs=0.025)
        assert found.is_told == (expected > 0.0)


def test_names_tell_as_numbers_do() -> None:
    """Two groups, means 0 and 1, variance 1 within: 0.25 of 1.25 is between them."""
    rng = np.random.default_rng(2)
    names = rng.choice(["a", "b"], 20000).tolist()
    y = np.array([name == "b" for name in names], dtype=float) + rng.normal(size=20000)
    found = first_order(classes_of(names), y)
    assert found is not None and found.value == pytest.approx(0.2, abs=0.015)


def test_chance_alone_is_seldom_told_from_nothing() -> None:
    rng = np.random.default_rng(3)
    found = [first_order(classes_of(rng.random(40).tolist()), rng.normal(size=40)) for _ in range(400)]
    assert sum(one is not None and one.is_told for one in found) <= 14  # 4 expected; 15 or more once in 40 000
    assert np.mean([one.value for one in found if one is not None]) < 0.05


def test_chance_alone_is_seldom_told_where_classes_are_nearly_as_many_as_runs() -> None:
    """Half of such campaigns were told: a failure that is alone in its class leaves nothing within classes."""
    rng = np.random.default_rng(7)
    names = [f"name {number}" for number in range(8)]
    found = [first_order(classes_of([*names, *names[:2]]), (rng.random(10) < 0.1) * 1.0) for _ in range(300)]
    assert sum(one is not None and one.is_told for one in found) <= 9  # 3 at most expected


@pytest.mark.parametrize("names", [["a", "b"] * 6, list("abcdef") * 2])
def test_what_few_runs_show_is_told(names: list[str]) -> None:
    rng = np.random.default_rng(8)
    y = np.array([ord(name) for name in names]) + 0.1 * rng.normal(size=len(names))
    found = first_order(classes_of(names), y)
    assert found is not None and found.is_told and found.value > 0.9


def test_how_often_chance_gives_as_much_is_what_all_ways_of_dealing_give() -> None:
    """Of two classes of five, against scipy's exact permutation test."""
    y = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 3.5, 4.5, 5.5, 6.5, 7.5])
    found = first_order(np.repeat([0, 1], 5), y)
    exact = stats.permutation_test((y[:5], y[5:]), lambda a, b: abs(np.mean(a) - np.mean(b)))
    assert found is not None and 0.05 < exact.pvalue < 0.2
    assert found.chance == pytest.approx(float(exact.pvalue), rel=0.7)  # ten as far apart are counted: 32 %


def test_rank_correlation_is_spearmans() -> None:
    rng = np.random.default_rng(4)
    x = rng.integers(0, 9, 60).astype(float)
    y = -(x**3) + rng.normal(size=60) * 90
    found = rank_correlation(x, y)
    assert found is not None and found.value == pytest.approx(float(stats.spearmanr(x, y).statistic), abs=1e-12)
    assert found.low < found.value < found.high < 0.0


def test_its_interval_holds_the_true_value_as_often_as_it_says() -> None:
    """Of normal pairs with correlation r, Spearman's is 6 / pi asin(r / 2) (Pearson 1907)."""
    rng, r = np.random.default_rng(5), 0.6
    true = 6.0 / np.pi * np.arcsin(r / 2.0)
    held = 0
    for _ in range(600):
        x = rng.normal(size=50)
        found = rank_correlation(x, r * x + np.sqrt(1.0 - r * r) * rng.normal(size=50))
        held += found is not None and found.low <= true <= found.high
    assert 0.92 <= held / 600 <= 0.98


def test_nothing_is_said_of_too_few_runs_or_of_what_is_constant() -> None:
    x = np.arange(20.0)
    assert rank_correlation(x, np.ones(20)) is None and first_order(classes_of(x.tolist()), np.ones(20)) is None
    assert rank_correlation(x[:5], x[:5]) is None and first_order(classes_of([1] * 20), x) is None
    assert first_order(np.arange(20), x) is None, "as many classes as runs"
    assert is_numeric([1, 2.5]) and not is_numeric([True]) and not is_numeric(["1"])


def test_a_wholly_determined_outcome_has_all_of_its_variance_from_the_input() -> None:
    found = first_order(classes_of(["a", "b"] * 10), np.array([1.0, 2.0] * 10))
    assert found is not None and found.value == pytest.approx(1.0) and found.is_told
