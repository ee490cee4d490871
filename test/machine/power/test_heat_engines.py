"""Closed forms of heat engines against each other, the book, and a cycle walked through point by point."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.heat_engines import brayton, carnot, curzon_ahlborn, otto

temperatures = st.tuples(st.floats(50.0, 400.0), st.floats(1.01, 10.0)).map(lambda pair: (pair[0] * pair[1], pair[0]))


@given(temperatures)
def test_the_efficiency_at_most_power_lies_between_half_of_carnot_and_carnot(ends: tuple[float, float]) -> None:
    """1 - sqrt(1 - c) is c/2 and more."""
    best = carnot(*ends)
    assert 0.5 * best <= curzon_ahlborn(*ends) <= best


@pytest.mark.published
def test_the_power_stations_of_curzon_and_ahlborn() -> None:
    """Their table: West Thurrock 565 and 25 C: 64.1 % of Carnot, 40 % at most power; CANDU 300 and 25 C: 48, 28 %."""
    for hot, cold, best, at_most_power in ((838.0, 298.0, 0.641, 0.40), (573.0, 298.0, 0.480, 0.28)):
        assert carnot(hot, cold) == pytest.approx(best, abs=0.005)
        assert curzon_ahlborn(hot, cold) == pytest.approx(at_most_power, abs=0.005)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.1, 0.9), st.floats(100.0, 300.0), st.floats(500.0, 1500.0))
def test_curzon_ahlborn_is_where_an_engine_between_resistances_gives_the_most(
    share: float, cold: float, hot: float
) -> None:
    """By search over its inner temperatures, each end losing heat over a resistance of its own."""

    inner = np.linspace(cold, hot, 200_001)[1:]
    taken = (hot - inner) / share
    # reversible inside: what goes out over what comes in is as the temperatures
    out = 1.0 - (1.0 - share) * taken / inner
    inner_cold = np.divide(cold, out, out=np.full(inner.shape, np.inf), where=out > 0.0)
    power = np.where(np.isfinite(inner_cold), taken * (1.0 - inner_cold / inner), -np.inf)
    best = int(power.argmax())
    assert 1.0 - inner_cold[best] / inner[best] == pytest.approx(curzon_ahlborn(hot, cold), abs=2e-3)


@given(st.floats(1.1, 20.0), st.floats(1.05, 1.66))
def test_otto_is_carnot_between_the_ends_of_its_compression(compression: float, heat_ratio: float) -> None:
    assert otto(compression, heat_ratio) == pytest.approx(carnot(compression ** (heat_ratio - 1.0), 1.0))


def test_otto_of_the_book() -> None:
    """Air, r = 8: 56.5 %."""
    assert otto(8.0) == pytest.approx(0.565, abs=5e-4)


@given(st.floats(1.1, 30.0), st.floats(1.1, 6.0), st.floats(1.1, 1.66))
def test_a_lossless_brayton_goes_by_its_pressures_alone(ratio: float, hotter: float, heat_ratio: float) -> None:
    x = ratio ** ((heat_ratio - 1.0) / heat_ratio)
    assume(hotter > 1.001 * x)
    assert brayton(ratio, hotter, heat_ratio) == pytest.approx(1.0 - 1.0 / x, rel=1e-6)


@given(st.floats(1.5, 6.0), st.floats(3.0, 6.0), st.floats(0.5, 1.0), st.floats(0.0, 1.0))
def test_no_brayton_beats_carnot_and_a_recuperator_never_harms(
    ratio: float, hotter: float, machine: float, part: float
) -> None:
    plain = brayton(ratio, hotter, 1.4, machine)
    better = brayton(ratio, hotter, 1.4, machine, part)
    assert plain - 1e-12 <= better <= carnot(hotter, 1.0) + 1e-12 or plain < 0.0


@pytest.mark.parametrize(
    "call",
    [
        lambda: carnot(200.0, 300.0),
        lambda: carnot(300.0, 0.0),
        lambda: curzon_ahlborn(math.nan, 300.0),
        lambda: otto(1.0),
        lambda: otto(8.0, 1.0),
        lambda: brayton(10.0, 1.5),
        lambda: brayton(10.0, 4.0, machine_efficiency=1.2),
        lambda: brayton(10.0, 4.0, recuperation=-0.1),
    ],
)
def test_what_no_engine_can_be_is_refused(call: object) -> None:
    with pytest.raises(InvalidValueError):
        call()  # type: ignore[operator]
