"""What the drive knows of the charge, and of what sources give, by what comes out of the stores."""

import math
from itertools import pairwise

import pytest
from hypothesis import given as examples
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.messages import battery_state
from sojourn_contract.values import BatteryState
from sojourn_drive.charge import NEW, ChargeGauge
from sojourn_flight.planning.energy_forecast import EnergyLeft

HOUSE_W, VOLTS, CAPACITY_C = 90.0, 28.0, 72_000.0


def gauge(scenario: str, house_power: float | None = HOUSE_W) -> ChargeGauge:
    return ChargeGauge(load_scenario(scenario).as_believed().power_manager, ["drive"], house_power)


def reading(power: float, charge: float = 0.6) -> BatteryState:
    """Of a store that gives so much [W]."""
    return battery_state(0, VOLTS, power / VOLTS, 280.0, charge, charge * CAPACITY_C, CAPACITY_C)


def after(gauge: ChargeGauge, powers: list[float], before: EnergyLeft | None, stands: bool) -> EnergyLeft:
    for power in powers:
        before = gauge.supply([reading(power)], before, stands)
    assert before is not None
    return before


@pytest.mark.parametrize("scenario", ["mars_sol", "isotope_sol"])
def test_a_drive_takes_what_sources_give_besides(scenario: str) -> None:
    """An array or a generator of 60 W: a drive of 40 W took 70 of the battery, and 70 was told for 130."""
    stands = after(gauge(scenario), [30.0] * 3, None, True)
    assert stands.given == pytest.approx(60.0, abs=1e-3) and stands.power == pytest.approx(HOUSE_W, abs=1e-3)
    drives = after(gauge(scenario), [70.0, 72.0], stands, False)
    assert drives.given == stands.given and drives.power == pytest.approx(132.0, abs=1e-3)


def test_a_source_that_charges_the_battery_gives_more_than_all_that_goes_on() -> None:
    stands = after(gauge("isotope_sol"), [-20.0], None, True)
    assert stands.given == pytest.approx(110.0, abs=1e-3)
    assert after(gauge("isotope_sol"), [20.0], stands, False).power == pytest.approx(130.0, abs=1e-3)


@pytest.mark.parametrize(("scenario", "house_power"), [("flat_drive", HOUSE_W), ("mars_sol", None)])
def test_without_sources_or_costs_all_that_is_known_comes_out_of_the_battery(
    scenario: str, house_power: float | None
) -> None:
    stands = after(gauge(scenario, house_power), [30.0], None, True)
    assert stands.given == 0.0 and stands.power == pytest.approx(30.0, abs=1e-3)
    assert after(gauge(scenario, house_power), [-5.0], stands, False).power == 0.0


def test_a_run_that_begins_with_a_drive_takes_its_first_reading_for_one_at_a_stand() -> None:
    begins = after(gauge("mars_sol"), [30.0], None, False)
    assert begins.given == pytest.approx(60.0, abs=1e-3)
    assert after(gauge("mars_sol"), [70.0], begins, False).given == begins.given


def test_what_is_given_follows_the_light_at_a_stand() -> None:
    reads, found = gauge("mars_sol"), [after(gauge("mars_sol"), [80.0], None, True)]
    for _ in range(40):
        found.append(after(reads, [40.0], found[-1], True))
    assert all(later.given > earlier.given for earlier, later in pairwise(found))
    assert found[1].given == pytest.approx((1.0 - NEW) * 10.0 + NEW * 50.0, abs=1e-3)
    assert found[-1].given == pytest.approx(50.0, abs=0.05)


@examples(st.lists(st.tuples(st.floats(-500.0, 500.0), st.booleans()), min_size=1, max_size=20))
def test_nothing_is_ever_given_or_taken_below_zero(seen: list[tuple[float, bool]]) -> None:
    reads, found = GAUGE, None
    for power, stands in seen:
        found = reads.supply([reading(power)], found, stands)
        assert found is not None and found.given >= 0.0 and found.power >= 0.0 and math.isfinite(found.power)
        assert reads.supply([None], found, stands) is found, "a reading that is not there changes nothing"


GAUGE = gauge("mars_sol")
