"""What the drive knows of the charge, and of what sources give, by what comes out of the stores."""

import math
from itertools import pairwise

import pytest
from hypothesis import given as examples
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.messages import battery_state
from sojourn_contract.values import BatteryState
from sojourn_drive.charge import NEW, ChargeGauge, PowerSituation
from sojourn_flight.planning.energy_forecast import EnergyLeft, on_grade
from sojourn_flight.planning.energy_params import EnergyParams

VOLTS, CAPACITY_C, SECOND = 28.0, 72_000.0, 1_000_000_000
COSTS = load_scenario("mars_sol").as_believed().drive.energy
assert COSTS is not None
HOUSE_W, METRE_J, RADIAN_J = COSTS.house_power, on_grade(COSTS, COSTS.energy_per_metre, 0.0), COSTS.energy_per_radian
STANDS, DRIVES = PowerSituation(True), PowerSituation(False, speed=0.1)


def gauge(scenario: str, costs: EnergyParams | None = COSTS) -> ChargeGauge:
    return ChargeGauge(load_scenario(scenario).as_believed().power_manager, ["drive"], costs)


def reading(power: float, stamp: int) -> BatteryState:
    """Of a store that gives so much [W]."""
    return battery_state(stamp, VOLTS, power / VOLTS, 280.0, 0.6, 0.6 * CAPACITY_C, CAPACITY_C)


def after(gauge: ChargeGauge, powers: list[float], before: EnergyLeft | None, situation: PowerSituation) -> EnergyLeft:
    """After a reading a second."""
    for power in powers:
        before = gauge.supply([reading(power, SECOND if before is None else before.stamp + SECOND)], before, situation)
    assert before is not None
    return before


@pytest.mark.parametrize("scenario", ["mars_sol", "isotope_sol"])
def test_a_drive_takes_what_sources_give_besides(scenario: str) -> None:
    """An array or a generator of 60 W: a drive of 40 W took 70 of the battery, and 70 was told for 130."""
    stands = after(gauge(scenario), [30.0] * 3, None, STANDS)
    assert stands.given == pytest.approx(HOUSE_W - 30.0, abs=1e-3) and stands.power == pytest.approx(HOUSE_W, abs=1e-3)
    drives = after(gauge(scenario), [70.0, 72.0], stands, DRIVES)
    assert drives.given == stands.given and drives.power == pytest.approx(72.0 + HOUSE_W - 30.0, abs=1e-3)


def test_a_source_that_charges_the_battery_gives_more_than_all_that_goes_on() -> None:
    stands = after(gauge("isotope_sol"), [-20.0], None, STANDS)
    assert stands.given == pytest.approx(HOUSE_W + 20.0, abs=1e-3)
    assert after(gauge("isotope_sol"), [20.0], stands, DRIVES).power == pytest.approx(HOUSE_W + 40.0, abs=1e-3)


@pytest.mark.parametrize(("scenario", "costs"), [("flat_drive", COSTS), ("mars_sol", None)])
def test_without_sources_or_costs_all_that_is_known_comes_out_of_the_battery(
    scenario: str, costs: EnergyParams | None
) -> None:
    stands = after(gauge(scenario, costs), [30.0], None, STANDS)
    assert stands.given == 0.0 and stands.power == pytest.approx(30.0, abs=1e-3)
    assert after(gauge(scenario, costs), [-5.0], stands, DRIVES).power == 0.0


def test_a_run_that_begins_with_a_drive_leaves_out_what_its_motion_costs() -> None:
    """Sixty watts are given: of the first readings, and until it has stood, by what the costs of driving leave."""
    reads, taken = gauge("mars_sol"), HOUSE_W + 0.1 * METRE_J
    begins = after(reads, [taken - 60.0] * 3, None, DRIVES)
    assert begins.given == pytest.approx(60.0, abs=1e-3) and begins.power == pytest.approx(taken, abs=1e-3)
    turns = PowerSituation(False, yaw_rate=-0.1)
    assert after(reads, [HOUSE_W + 0.1 * RADIAN_J - 60.0], None, turns).given == pytest.approx(60.0, abs=1e-3)
    stands = after(reads, [HOUSE_W - 50.0], begins, STANDS)
    assert stands.given == pytest.approx(50.0, abs=1e-3), "the first at a stand counts alone"
    assert after(reads, [10.0], stands, DRIVES).given == stands.given


def test_what_is_switched_off_is_not_given() -> None:
    """At night, cameras and heaters off, a rover was told 85 W where 61 W left its battery, all there was."""
    reads = gauge("mars_sol")
    assert reads.off({"cameras": "on", "drive": "off", "steer": "0.5"}) == 0.0
    off = reads.off({"cameras": "off", "imu": "off", "drive": "off"})
    assert off == sum(load.power_w for load in LOADS if load.name in ("cameras", "imu"))
    dark = after(reads, [HOUSE_W - off], None, PowerSituation(True, off=off))
    assert dark.given == pytest.approx(0.0, abs=1e-3) and dark.power == pytest.approx(HOUSE_W - off, abs=1e-3)


def test_a_reading_counts_once_however_often_it_is_heard() -> None:
    """In real time one is heard for up to three seconds, also when the rover has stopped meanwhile."""
    reads = gauge("mars_sol")
    stands = after(reads, [30.0], None, STANDS)
    drives = after(reads, [71.0], stands, DRIVES)
    for _ in range(15):
        assert reads.supply([reading(71.0, drives.stamp)], drives, STANDS) is drives
    back = reads.supply([reading(30.0, 5)], drives, STANDS)
    assert back is not None and back.stamp == 5, "a clock that is put back is followed"


def test_what_is_given_follows_the_light_at_a_stand() -> None:
    reads, found = gauge("mars_sol"), [after(gauge("mars_sol"), [80.0], None, STANDS)]
    for _ in range(40):
        found.append(after(reads, [40.0], found[-1], STANDS))
    assert all(later.given > earlier.given for earlier, later in pairwise(found))
    assert found[1].given == pytest.approx((1.0 - NEW) * (HOUSE_W - 80.0) + NEW * (HOUSE_W - 40.0), abs=1e-3)
    assert found[-1].given == pytest.approx(HOUSE_W - 40.0, abs=0.05)


@examples(st.lists(st.tuples(st.floats(-500.0, 500.0), st.sampled_from((STANDS, DRIVES))), min_size=1, max_size=20))
def test_nothing_is_ever_given_or_taken_below_zero(seen: list[tuple[float, PowerSituation]]) -> None:
    reads, found = GAUGE, None
    for power, situation in seen:
        found = after(reads, [power], found, situation)
        assert found.given >= 0.0 and found.power >= 0.0 and math.isfinite(found.power)
        assert reads.supply([None], found, situation) is found, "a reading that is not there changes nothing"


GAUGE = gauge("mars_sol")
LOADS = load_scenario("mars_sol").as_believed().power_manager.loads
