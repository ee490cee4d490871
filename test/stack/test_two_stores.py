"""A machine with two energy stores and a source: driven, recorded, judged, and its energy accounted for."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.contract_version import check_contract, table_of_bag
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.replay_script import script_of
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.page import contract_page
from sojourn_machine.power.stores import StoreParams
from sojourn_physics.plant.state import PlantState
from sojourn_stack import run as direct

SCENARIO = str(Path(__file__).with_suffix("").parent / "two_stores.yaml")
ROLES = ("plant", "sensors", "drive", "power", "operator", "recorder")
SHORT = ("steps=[{wait_s: 2.0}]",)
FURTHER = ("/truth/electrical/capacitors", "/bus/state/capacitors", "/battery_state/capacitors")


@dataclass
class Driven:
    """A run over its course: the plant at each period, and the bag."""

    plants: list[PlantState]
    result: direct.Result
    bag: Bag


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Driven:
    folder, plants = tmp_path_factory.mktemp("driven") / "bag", list[PlantState]()

    def keep(state: Any) -> bool:
        plants.append(state.roles["plant"].app.machine)
        return True

    result = direct.run(direct.RunSpec(SCENARIO, ROLES, bag=folder), keep)
    return Driven(plants, result, read_bag(folder))


def stored(stores: Mapping[str, StoreParams], plant: PlantState) -> float:
    """Energy in the stores, that of the battery's polarisation among it [J]."""
    battery: Any = plant.power.stores[0]
    held = sum(store.stored_energy(state.soc) for store, state in zip(stores.values(), plant.power.stores, strict=True))
    capacitance = stores["battery"].capacitance  # type: ignore[attr-defined]
    return held + 0.5 * capacitance * battery.polarisation_voltage**2


def test_it_drives_where_it_is_asked_to_and_keeps_the_contract(driven: Driven) -> None:
    assert [step.good for step in driven.result.steps] == [True]
    assert driven.result.completeness is not None and not driven.result.completeness.gaps
    check_contract(driven.bag)
    report, _ = judge_bag(driven.bag)
    assert report.violations == 0 and set(FURTHER) <= set(report.messages)


def test_the_energy_of_sources_and_stores_is_that_of_loads_and_heat(driven: Driven) -> None:
    """To 0.1 % of what was turned over; the buses alone to rounding."""
    scenario = load_scenario(SCENARIO)
    stores, first, last = scenario.power.all_stores, driven.plants[0], driven.plants[-1]
    account, after = last.power.energy, last.power.stores
    assert account.sources > 500.0 and account.loads > 500.0 and account.converters > 0.0
    balance = account.sources + account.stores - account.loads - account.converters - account.shunts
    assert abs(balance) < 1e-9 * account.loads
    heat = sum(state.energy_heat for state in after)  # type: ignore[attr-defined]
    assert scenario.config.battery_soc == 0.7
    initial = sum(store.stored_energy(0.7) for store in stores.values())
    spent = initial - stored(stores, last)
    missing = account.sources + spent - account.loads - account.converters - account.shunts - heat
    assert abs(missing) < 1e-3 * (account.sources + abs(spent))
    assert first.power.voltages[1] == 12.0


def test_the_generator_gives_all_it_has_and_the_stores_share_the_rest(driven: Driven) -> None:
    loads = driven.bag["/truth/loads"].statuses()
    powers = [float(status["source generator"]) for status in loads[1:]]  # the first is before the first period
    assert np.array(powers) == pytest.approx(110.0, rel=1e-3)
    battery, bank = driven.bag["/truth/electrical"], driven.bag[FURTHER[0]]
    assert float(loads[-1]["network sources"]) == pytest.approx(driven.plants[-1].power.energy.sources, rel=0.02)
    assert np.array_equal(battery.column("voltage"), bank.column("voltage"))
    currents = [-bag.column("current") for bag in (battery, bank)]
    assert np.ptp(currents[1]) > 1.0, "the capacitors take no part"
    estimates = driven.bag[FURTHER[2]].column("percentage")
    truths = bank.column("percentage")
    assert estimates[-1] == pytest.approx(truths[-1], abs=0.05)


def test_a_run_of_two_stores_is_recorded_judged_and_compared(tmp_path: Path) -> None:
    bags = []
    for name in ("one", "other"):
        spec = direct.RunSpec(SCENARIO, ROLES, SHORT, bag=tmp_path / name)
        result = direct.run(spec)
        assert result.completeness is not None and not result.completeness.gaps
        # the recorder waits for the further rows as for the first ones
        counts = result.completeness.counts
        for topic in FURTHER:
            first = topic.removesuffix("/capacitors")
            assert counts[topic] == counts[first] and counts[topic].due
        bags.append(read_bag(tmp_path / name))
    one, other = bags
    assert compare(one.topics, other.topics).verdict is Verdict.IDENTICAL
    assert [row.name for row in script_of(one, "sensors").inputs if row.thing] == [FURTHER[0]]
    assert set(script_of(one, "power").due) >= {"/battery_state", FURTHER[2]}

    del other.topics["/bus/state/capacitors"]
    found, _ = judge_bag(other)
    assert {group.topic for group in found.groups if group.rule == "answer"} == {"/bus/state/capacitors"}


def test_the_contract_shows_what_the_machine_of_a_run_has() -> None:
    machine = JudgedMachine.of_scenario(load_scenario(SCENARIO))
    page = contract_page(machine)
    assert all(name in machine.table and name in page for name in FURTHER)
    assert "spectrometer" in machine.loads


def test_a_bag_says_itself_which_stores_its_machine_had(tmp_path: Path) -> None:
    direct.run(direct.RunSpec(SCENARIO, ROLES, SHORT, bag=tmp_path / "bag"), lambda state: state.period <= 1)
    assert set(FURTHER) <= {row.name for row in table_of_bag(read_bag(tmp_path / "bag"))}


def test_any_store_is_set_by_its_name_in_truth_and_in_belief() -> None:
    apart = ["stores.capacitors.capacitance=40.0", "belief.stores.capacitors.capacitance=70.0"]
    scenario = load_scenario(SCENARIO, apart)
    truth, belief = scenario.power.stores["capacitors"], scenario.as_believed().power.stores["capacitors"]
    assert (truth.capacitance, belief.capacitance) == (40.0, 70.0)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("stores.capacitors.kind=supercapaciter", "did you mean supercapacitor?"),
        ("sources.generator.kind=rtg", "radioisotope_generator"),
        ("sources.generator.bus=mian", "did you mean main?"),
        ("converters.regulator.input=payload", "payload <- payload"),
        ("buses.payload.loads[0].power_w=90.0", "allowed is at most 60 W"),
        ("buses.payload.loads[0].name=drive", "allowed is another name"),
        ("power_manager.load_limits.drve=3.0", "did you mean drive?"),
        ("buses.spare={lockout_voltage: 1.0, lockout_reset_voltage: 2.0, lockout_reset_time: 1.0}", "has none"),
        ("belief.stores.another={kind: battery, extends: nca_cell}", "stores.another"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(override: str, words: str) -> None:
    with pytest.raises(ConfigError) as told:
        load_scenario(SCENARIO, [override])
    assert words in str(told.value)
