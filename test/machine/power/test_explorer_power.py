"""The explorer's own parameter sets: their sizes, and battery, bus and manager together until empty."""

import pytest

from sojourn_config.machine_reader import joined_machine
from sojourn_flight.power_manager import law as manager
from sojourn_flight.power_manager.law import PowerManagerInput
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.power import battery
from sojourn_machine.power.network import PowerNetwork

EXPLORER = joined_machine("explorer")
PACK, BUS = EXPLORER.power.battery, EXPLORER.power.bus
PARAMS = PowerManagerParams(power=EXPLORER.power, law=EXPLORER.law, derated=("drive",))


@pytest.mark.published("batteries of the Mars Exploration Rovers, and data sheets of cells of 2.9 Ah")
def test_the_pack_is_of_the_mer_class() -> None:
    assert PACK.cells_series * 3.69 == pytest.approx(28.0, rel=0.06)
    assert PACK.energy_capacity_wh == pytest.approx(450.0, rel=0.06)
    for soc, cell, band in ((0.0, 2.85, 0.15), (0.1, 3.33, 0.01), (0.5, 3.69, 0.01), (1.0, 4.18, 0.01)):
        assert battery.open_circuit_voltage(PACK, soc) / 8 == pytest.approx(cell, abs=band)
    # the published 35-45 mohm of a cell of 2.9 Ah, at this cell's size
    ohmic, polarisation = battery.resistances(PACK, 298.15)
    cell = (ohmic + polarisation) * PACK.cells_parallel / PACK.cells_series
    assert 0.035 <= cell * PACK.capacity_ah / 2.9 <= 0.045


def test_the_hysteresis_of_the_bus_is_larger_than_the_rebound_of_shedding_a_level() -> None:
    ohmic, polarisation = battery.resistances(PACK, 273.15)
    law = PARAMS.law
    for priority in PARAMS.shed_priorities:
        power = sum(load.power_w for load in BUS.loads if load.priority == priority and not load.essential)
        assert (ohmic + polarisation) * power / law.shed_voltage < law.shed_voltage_hysteresis
    assert law.shed_voltage > BUS.lockout_voltage


def test_a_full_battery_driven_until_empty_sheds_in_order_and_keeps_the_computer_to_the_end() -> None:
    dt, demand = 5.0, tuple(60.0 if load.name == "drive" else 0.0 for load in BUS.loads)
    network = PowerNetwork(EXPLORER.power)
    awake = PARAMS.model_copy(
        update={"law": PARAMS.law.model_copy(update={"sleep": None})}
    )  # or its computer would rest
    power, state = network.initial_state(1.0), manager.initial_state(awake, 1.0)
    fractions: tuple[float, ...] = (1.0,) * len(BUS.loads)
    levels, delivered = [0], 0.0
    computer = [load.name for load in BUS.loads].index("computer")
    while power.stores[0].soc > 0.0:
        power, electrical = network.step(power, fractions, demand, dt)
        cell = power.stores[0]
        if cell.soc > 0.0:  # the last step has what was left
            assert electrical.load_power[computer] == pytest.approx(30.0)
            assert not electrical.brownout
        delivered += float(electrical.load_power.sum()) * dt
        telemetry = PowerManagerInput(
            (StoreReading(electrical.voltage, electrical.store_currents[0], cell.temperature),)
        )
        state, output = manager.step(awake, state, telemetry, dt)
        fractions = output.fractions
        levels.append(output.shed_level)
    assert output.soc == pytest.approx(0.0, abs=0.02)
    assert levels == sorted(levels)  # constant drain: nothing comes back
    assert levels[-1] == len(PARAMS.shed_priorities)
    # nothing is lost between battery and loads, and a pack of 0.06 ohm wastes a few per cent
    assert delivered == pytest.approx(cell.energy_terminal, rel=0.01)
    assert 0.95 < delivered / 3600.0 / PACK.energy_capacity_wh < 1.0
