"""Stirling generator, concentrator and engines on propellants: classes, limits, accounts; all in one network."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import BATTERY, CAPACITOR, bus, imbalance, load

from sojourn_config.load import load_params
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.fission_reactor import FissionReactorParams
from sojourn_machine.power.fuel_cell import FuelCellParams
from sojourn_machine.power.heat_engine import HeatEngineParams
from sojourn_machine.power.heat_engines import carnot, otto
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.radioisotope_generator import SECONDS_PER_YEAR, RadioisotopeGeneratorParams
from sojourn_machine.power.solar_concentrator import SolarConcentratorParams
from sojourn_machine.power.sources import SOURCES
from sojourn_machine.power.stirling_generator import StirlingGeneratorParams, StirlingState
from sojourn_machine.power.surroundings import DARK, PowerSurroundings
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN

KRUSTY = load_params("parts", "krusty", FissionReactorParams)
ASRG = load_params("parts", "asrg", StirlingGeneratorParams)
MIRROR = SolarConcentratorParams(
    mirror_area=4.0, concentration=800.0, optical_efficiency=0.8, receiver_emissivity=0.9, receiver_temperature=1000.0,
    cold_end=320.0, carnot_fraction=0.5,
)  # fmt: skip
ENGINE = HeatEngineParams.model_validate(
    {"engine": {"cycle": "otto", "compression_ratio": 9.0}, "quality": 0.6, "heating_value": 1.0e7, "rated_w": 2000.0,
     "propellant": 40.0}
)  # fmt: skip
NOON = PowerSurroundings(to_sun=np.array((0.0, 0.0, 1.0)), direct=1361.0)
ARM_LENGTHS = st.floats(0.0, 1.0)


def test_the_stirling_generator_is_of_its_class() -> None:
    """130 to 140 W of 500 W of heat, four times what thermocouples make of it."""
    start = ASRG.initial_state()
    powers = [ASRG.point(start, DARK._replace(temperature=around)).power for around in (4.0, 200.0, 300.0)]
    assert powers == sorted(powers, reverse=True)
    assert all(130.0 < power < 145.0 for power in powers)
    later = ASRG.point(StirlingState(14.0 * SECONDS_PER_YEAR), DARK._replace(temperature=200.0)).power
    assert later / powers[1] == pytest.approx(0.8953, abs=0.02)  # the fuel, less what a colder radiator gives back


@given(st.floats(1.0, 500.0), st.floats(2.7, 400.0))
def test_its_radiator_gives_off_what_is_no_power(heat: float, around: float) -> None:
    cold = ASRG.cold_end(heat, around)
    given_off = ASRG.radiator_emissivity * STEFAN_BOLTZMANN * ASRG.radiator_area * (cold**4 - around**4)
    power = ASRG.carnot_fraction * carnot(ASRG.hot_end, cold) * (1.0 - ASRG.leak) * heat
    assert given_off + power == pytest.approx(heat, rel=1e-6)


def test_a_hotter_receiver_is_better_up_to_a_point() -> None:
    """The best temperature by search is where the slope vanishes, and grows with the concentration."""
    best = MIRROR.best_receiver_temperature(1361.0)
    around = MIRROR.temperature_surroundings
    here = MIRROR.power(1361.0, best, around)
    assert here > max(MIRROR.power(1361.0, best + step, around) for step in (-20.0, 20.0))
    tighter = MIRROR.model_copy(update={"concentration": 3000.0})
    assert tighter.best_receiver_temperature(1361.0) > best > 800.0
    assert MIRROR.best_receiver_temperature(300.0) < best


@settings(deadline=None)
@given(st.floats(200.0, 1100.0))
def test_no_engine_gives_its_heat_to_what_is_hotter(around: float) -> None:
    """On Venus a mirror's engine whose cold end was said to be at 320 K had it there, among 735 K, and a receiver of
    600 K was given more by the air than by the Sun.
    """
    hot = NOON._replace(temperature=around)
    power = MIRROR.point(MIRROR.initial_state(), hot).power
    light = MIRROR.optical_efficiency * MIRROR.mirror_area * hot.direct
    assert 0.0 <= power <= max(1.0 - max(around, MIRROR.cold_end) / MIRROR.receiver_temperature, 0.0) * light
    assert (power > 0.0) == (around < MIRROR.receiver_temperature)
    core = KRUSTY.initial_state()
    best = max(1.0 - max(around, KRUSTY.cold_end) / KRUSTY.working_temperature, 0.0)
    assert KRUSTY.point(core, hot).power == pytest.approx(KRUSTY.carnot_fraction * best * KRUSTY.heat_pipe_limit)


@given(st.floats(0.0, 2000.0), st.floats(330.0, 2000.0), st.floats(2.7, 400.0))
def test_the_concentrator_never_makes_more_than_carnot_of_the_light(
    light: float, receiver: float, around: float
) -> None:
    most = carnot(receiver, min(MIRROR.cold_end, receiver)) * MIRROR.mirror_area * light
    assert 0.0 <= MIRROR.power(light, receiver, around) <= most


def test_it_needs_a_beam_above_the_deck() -> None:
    state = MIRROR.initial_state()
    assert MIRROR.point(state, NOON).power == pytest.approx(MIRROR.most_power)
    low = PowerSurroundings(to_sun=np.array((math.cos(0.05), 0.0, math.sin(0.05))), direct=1361.0)
    assert MIRROR.point(state, low).power == 0.0
    assert MIRROR.point(state, PowerSurroundings(to_sun=NOON.to_sun, diffuse=500.0)).power == 0.0
    assert MIRROR.point(state, DARK).power == 0.0


def test_an_engine_burns_what_its_efficiency_says() -> None:
    assert ENGINE.efficiency == pytest.approx(0.6 * 0.81 * otto(9.0, 1.3))
    state = ENGINE.initial_state()
    for _ in range(60):
        state = ENGINE.step(state, 1500.0, 60.0)
    assert 40.0 - state.propellant == pytest.approx(1500.0 * 3600.0 / (ENGINE.efficiency * 1e7), rel=1e-9)
    assert ENGINE.step(state, 0.0, 60.0) == state
    assert state.energy + state.energy_heat == pytest.approx((40.0 - state.propellant) * 1e7, rel=1e-9)


def test_a_tank_empties_once() -> None:
    small = ENGINE.model_copy(update={"propellant": 0.1})
    state = small.initial_state()
    while small.point(state).power > 0.0:
        state = small.step(state, 2000.0, 60.0)
    assert -0.1 < state.propellant <= 0.0 and small.point(state).power == 0.0


@settings(max_examples=30, deadline=None)
@given(loads=st.lists(st.floats(0.0, 3000.0), min_size=3, max_size=40), soc=st.floats(0.1, 0.9))
def test_every_source_in_one_network_over_a_day(loads: list[float], soc: float) -> None:
    """Six sources, two stores, half an hour a step: the account closes, and no heat is less than nothing."""
    sources = {
        "isotope": load_params("parts", "mmrtg", RadioisotopeGeneratorParams),
        "stirling": ASRG,
        "mirror": MIRROR,
        "reactor": KRUSTY,
        "cell": load_params("parts", "ballard_mark_v", FuelCellParams),
        "engine": ENGINE,
    }
    params = PowerParams(
        battery=BatteryParams(**BATTERY | {"capacity_ah": 80.0, "charge_current_limit": 20.0}),
        stores={"bank": CAPACITOR},
        sources=sources,
        bus=bus(load("motor", 4000.0)),
    )
    network = PowerNetwork(params)
    state = network.initial_state(soc)
    for place, power in enumerate(loads):
        around = NOON if place % 3 else DARK
        before = state
        state, output = network.step(state, (1.0,), (power,), 1800.0, around)
        for number, source in enumerate(network.sources):
            given_heat = source.heat_given(before.sources[number], state.sources[number])
            assert given_heat >= -1e-6 * (1.0 + output.source_powers[number] * 1800.0)
    assert imbalance(state) < 1e-9


def test_all_kinds_are_registered() -> None:
    names = {"fission_reactor", "fuel_cell", "heat_engine", "solar_concentrator", "stirling_generator"}
    assert names <= set(SOURCES.names())
    for name in names:
        assert SOURCES.get(name).model_fields["kind"].default == name


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (ASRG, {"hot_end": 200.0}),
        (ASRG, {"carnot_fraction": 1.0}),
        (MIRROR, {"concentration": 1e5}),
        (ENGINE, {"engine": {"cycle": "otto", "compression_ratio": 0.9}}),
        (ENGINE, {"engine": {"cycle": "diesel", "compression_ratio": 20.0}}),
    ],
)
def test_what_cannot_be_is_refused(kind: Any, values: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        type(kind)(**(kind.model_dump() | values))


@pytest.mark.parametrize("hotter", [3.2, 4.0])
def test_a_gas_turbine_that_its_compressor_would_stop_is_refused(hotter: float) -> None:
    """Colder than what is compressed, or too little hotter to pay for the compression."""
    cycle = {"cycle": "brayton", "pressure_ratio": 30.0, "temperature_ratio": hotter, "machine_efficiency": 0.7}
    with pytest.raises(ValidationError, match=r"temperature.ratio"):
        HeatEngineParams.model_validate(ENGINE.model_dump() | {"engine": cycle})


@settings(max_examples=25)
@given(st.lists(st.sampled_from((0, 1)), min_size=60, max_size=130), st.floats(0.0, 200.0))
def test_what_sources_offer_is_worked_out_anew_when_it_is_another(which: list[int], asked: float) -> None:
    """What has been worked out of the same surroundings stands while the array's state waits for its second."""
    made = PowerParams(
        battery=BatteryParams(**BATTERY),
        bus=bus(load("motor", 500.0)),
        sources={"array": load_params("parts", "mer_array", PhotovoltaicArrayParams), "asrg": ASRG},
    )
    network, lights = PowerNetwork(made), (NOON, NOON._replace(direct=400.0))
    state = network.initial_state(0.5)
    for number in which:
        state, _ = network.step(state, [1.0], [asked], 0.02, lights[number])
        before = state
        state, output = network.step(before, [1.0], [asked], 0.02, lights[number])
        true = [one.point(each, lights[number]) for one, each in zip(network.sources, before.sources, strict=True)]
        assert list(state.offers) == true
        assert output.offered == sum(offer.power for offer in true)
