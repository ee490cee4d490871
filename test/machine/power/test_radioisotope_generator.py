"""The radioisotope generator against published figures."""

from itertools import pairwise

import pytest
from pydantic import ValidationError

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.radioisotope_generator import SECONDS_PER_YEAR, GeneratorState, RadioisotopeGeneratorParams

MMRTG = load_params("parts", "mmrtg", RadioisotopeGeneratorParams)


def test_it_starts_with_its_design_figures() -> None:
    state = MMRTG.initial_state()
    assert MMRTG.point(state).power == 110.0
    assert MMRTG.heat(state) == pytest.approx(2000.0 - 110.0)


@pytest.mark.published
def test_the_fuel_decays_as_plutonium_238() -> None:
    """0.787 % in the first year, 0.8953 left after 14, a half after 87.7."""
    for years, left in ((1.0, 1.0 - 0.00787), (14.0, 0.8953), (87.7, 0.5)):
        assert MMRTG.decayed(GeneratorState(years * SECONDS_PER_YEAR)) == pytest.approx(left, abs=5e-5)


def test_the_electric_power_falls_as_reported_from_mars() -> None:
    """3.8 to 4.8 % a year in all."""
    powers = [MMRTG.point(GeneratorState(years * SECONDS_PER_YEAR)).power for years in range(15)]
    for before, after in pairwise(powers):
        assert 0.038 <= 1.0 - after / before <= 0.0481


def test_a_step_makes_it_older_and_counts_what_it_gave() -> None:
    state = MMRTG.step(MMRTG.initial_state(), 80.0, 3600.0)
    assert (state.age, state.energy) == (3600.0, 288000.0)
    for power, dt in ((float("nan"), 1.0), (1.0, 0.0), (1.0, float("inf"))):
        with pytest.raises(InvalidValueError):
            MMRTG.step(state, power, dt)


@pytest.mark.parametrize("thermal", [50.0, 110.0])
def test_no_more_power_than_heat(thermal: float) -> None:
    with pytest.raises(ValidationError, match=r"electric_power_w = 110.*less than thermal_power_w"):
        RadioisotopeGeneratorParams(**MMRTG.model_dump() | {"thermal_power_w": thermal})
