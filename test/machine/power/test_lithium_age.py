"""A lithium battery that is old or out of balance: the published law, and what a pack of such cells gives."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import BATTERY

from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.lithium_age import LithiumAge


def test_a_cell_on_a_hot_shelf_loses_as_was_measured() -> None:
    """Schmalstieg et al. 2014, at 50 C: some fifth of the capacity in 485 days at half of the charge, more where it is
    full, less where it is colder.
    """
    shelf = dict(years=485.0 / 365.25, temperature=323.15)
    half, full = LithiumAge(**shelf), LithiumAge(**shelf, storage_voltage=4.1)
    assert 0.75 < half.capacity_left < 0.88 and full.capacity_left < half.capacity_left
    assert LithiumAge(years=485.0 / 365.25, temperature=308.15).capacity_left > 0.92
    assert 1.1 < half.resistance < 2.0


def test_by_hand() -> None:
    """One year at 25 C and 3.8 V, 100 cycles of 0.8 about 3.7 V."""
    age = LithiumAge(
        years=1.0, temperature=298.15, storage_voltage=3.8, cycles=100.0, cycle_depth=0.8, cycle_voltage=3.7
    )
    assert age.capacity_left == pytest.approx(1.0 - 0.028307 - 0.083625, abs=1e-5)


ages = st.builds(
    LithiumAge,
    years=st.floats(0.0, 3.0),
    temperature=st.floats(253.0, 300.0),
    storage_voltage=st.floats(3.3, 4.0),
    cycles=st.floats(0.0, 300.0),
    cycle_depth=st.floats(0.01, 1.0),
)


@given(ages, st.floats(0.01, 1.0))
def test_nothing_grows_younger(age: LithiumAge, more: float) -> None:
    older = age.model_copy(update={"years": age.years + more, "cycles": age.cycles + 100.0 * more})
    assert older.capacity_left < age.capacity_left <= 1.0 and older.resistance >= age.resistance >= 1.0


@given(ages, st.floats(0.0, 0.3))
def test_an_old_pack_gives_less_over_more_resistance(age: LithiumAge, imbalance: float) -> None:
    new, old = BatteryParams(**BATTERY), BatteryParams(**BATTERY | {"age": age, "imbalance": imbalance})
    left = (1.0 - imbalance) * age.capacity_left
    assert old.charge_capacity == pytest.approx(left * new.charge_capacity)
    assert old.stored_energy(1.0) == pytest.approx(left * new.stored_energy(1.0))
    assert old.settled_resistance(290.0) == pytest.approx(age.resistance * new.settled_resistance(290.0))
    assert old.open_circuit_voltage(0.4) == new.open_circuit_voltage(0.4)


def test_a_new_pack_is_bit_for_bit_what_it_was() -> None:
    pack = BatteryParams(**BATTERY)
    assert pack.charge_capacity == BATTERY["cells_parallel"] * BATTERY["capacity_ah"] * 3600.0
    assert pack.tables.ohmic.tolist() == [8.0 * 0.01]
    assert LithiumAge().capacity_left == 1.0 and LithiumAge().resistance == 1.0


def test_what_is_worn_out_is_refused() -> None:
    with pytest.raises(ValidationError, match="half of the capacity"):
        LithiumAge(years=50.0, temperature=330.0)
    with pytest.raises(ValidationError, match="imbalance"):
        BatteryParams(**BATTERY | {"imbalance": 0.7})
