"""The step as a function: same input, same output; a copy is a branch; bad input is refused by name."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.step import initial_state, step
from sojourn_physics.terrain.height_field import OutsideTerrainError
from sojourn_plant.start import build_plant

Numbers = Callable[[Any], Any]


def test_two_machines_run_alike_bit_for_bit(flat: Any, numbers_of: Numbers) -> None:
    model, start = build_plant(load_scenario("flat_drive"))
    assert np.array_equal(numbers_of(start), numbers_of(flat.start))
    here = there = start
    for _ in range(100):
        here, _ = step(model, here, flat.hold(0.6))
        there, _ = step(flat.model, there, flat.hold(0.6))
    assert np.array_equal(numbers_of(here), numbers_of(there))


def test_a_copy_goes_on_alike_bit_for_bit(flat: Any, numbers_of: Numbers) -> None:
    middle = flat.run(2.0, flat.hold(0.6))
    saved = middle.copy()
    kept = numbers_of(middle)
    end = flat.run(2.0, flat.hold(-0.4), middle)
    flat.run(1.0, flat.hold(1.0))  # something else in the model's working memory
    again = flat.run(2.0, flat.hold(-0.4), saved)
    assert np.array_equal(numbers_of(end), numbers_of(again))
    assert np.array_equal(numbers_of(middle), kept)  # a step does not write on its input
    assert end.tick == middle.tick + 100


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
@pytest.mark.parametrize("row", [0, 1, 2])
def test_a_command_that_is_not_finite_is_refused(flat: Any, value: float, row: int) -> None:
    command = flat.hold()
    command.reference[row, 3] = value
    with pytest.raises(InvalidValueError, match="command"):
        step(flat.model, flat.start, command)


@pytest.mark.parametrize(("value", "words"), [(float("nan"), "command"), (-0.1, "0 to 1"), (1.1, "0 to 1")])
def test_a_load_fraction_outside_0_to_1_is_refused(flat: Any, value: float, words: str) -> None:
    command = flat.hold()
    command.load_fractions[0] = value
    with pytest.raises(InvalidValueError, match=words):
        step(flat.model, flat.start, command)


def test_a_command_of_another_shape_is_refused(flat: Any) -> None:
    command = flat.hold()
    for wrong in (
        replace(command, reference=command.reference[:, :-1]),
        replace(command, reference=command.reference[:2]),
        replace(command, load_fractions=command.load_fractions[:-1]),
    ):
        with pytest.raises(InvalidValueError, match="shape"):
            step(flat.model, flat.start, wrong)


def test_a_state_that_explodes_is_told(flat: Any) -> None:
    state = flat.start.copy()
    state.velocity[0] = np.nan
    with pytest.raises(InvalidValueError, match="infinite at tick 1"):
        step(flat.model, state, flat.hold())


def test_a_load_that_is_off_lets_its_wheels_stand(flat: Any) -> None:
    command = flat.hold(0.6)
    command.load_fractions[[load.name for load in flat.model.loads].index("drive")] = 0.0
    end = flat.run(2.0, command)
    assert abs(end.configuration[0] - flat.start.configuration[0]) < 1e-3
    assert end.energy.electrical == pytest.approx(0.0, abs=0.1)


def test_start_where_there_is_no_ground_is_refused(flat: Any) -> None:
    with pytest.raises(OutsideTerrainError):
        initial_state(flat.model, 50.0, 0.0, 0.0, 0.8)


def test_start_with_an_unknown_joint_is_refused(flat: Any) -> None:
    with pytest.raises(InvalidValueError, match=r"arm_elbo_joint.*arm_elbow_joint"):
        initial_state(flat.model, 0.0, 0.0, 0.0, 0.8, {"arm_elbo_joint": 0.1})


def build(scenario: Any, changes: dict[str, Any]) -> PlantModel:
    machine = MachineParams.model_validate({
        name: changes.get(name, getattr(scenario.machine, name)) for name in MachineParams.model_fields
    })  # fmt: skip
    soils = [soil for soil in scenario.soils.values() if soil.name not in changes.get("without", ())]
    site = Site(scenario.height_field(), soils, scenario.gravity_field)
    return PlantModel(scenario.urdf_xml, machine, site, scenario.power)


def test_names_that_do_not_fit_are_refused(flat: Any) -> None:
    scenario = load_scenario("flat_drive")
    rover = scenario.machine
    drive, *others = rover.drives
    wheel, *wheels = rover.wheels
    pad, *pads = rover.pads
    cases: list[tuple[dict[str, Any], str]] = [
        (
            {"drives": (drive.model_copy(update={"joints": ("nosuch_joint",)}), *others)},
            "nosuch_joint.*wheel_",
        ),
        ({"drives": (drive.model_copy(update={"load": "turbo"}), *others)}, "turbo.*drive"),
        ({"wheels": (wheel.model_copy(update={"joint": "wheel_x"}), *wheels)}, "wheel_x.*wheel_front_left"),
        ({"pads": (pad.model_copy(update={"link": "roof_link"}), *pads)}, "roof_link.*link of the URDF"),
        (
            {"couplings": (rover.couplings[0].model_copy(update={"first": "rocker_joint"}),)},
            "rocker_joint.*rocker_left",
        ),
        ({"without": ("lunar_nominal",)}, "lunar_nominal.*rigid_rock"),
    ]
    for changes, words in cases:
        with pytest.raises(InvalidValueError, match=words):
            build(scenario, changes)


def test_machines_that_contradict_themselves_are_refused() -> None:
    rover = load_scenario("flat_drive").machine
    good = {name: getattr(rover, name) for name in MachineParams.model_fields}
    with pytest.raises(ValidationError, match="2 drives"):
        MachineParams.model_validate({**good, "drives": (*rover.drives, rover.drives[0])})
    with pytest.raises(ValidationError, match="used 2 times"):
        MachineParams.model_validate({**good, "wheels": (*rover.wheels, rover.wheels[0])})
    with pytest.raises(ValidationError, match="has no drive"):
        MachineParams.model_validate({**good, "drives": rover.drives[:1]})


@pytest.mark.parametrize(("physics", "control"), [(0.003, 0.02), (0.005, 0.002), (0.0015, 0.001)])
def test_a_control_period_is_a_whole_number_of_steps(physics: float, control: float) -> None:
    with pytest.raises(ValidationError, match="whole multiple"):
        SimulationParams(physics_step=physics, control_period=control)
    assert SimulationParams(physics_step=0.002, control_period=0.02).substeps == 10
