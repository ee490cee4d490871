"""The explorer on wheels of different contact models: stands, parks, drives, and its energies balance."""

import math
from typing import Any

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.supports import WheelParams
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_physics.soil.params import SoilParams

Contact = dict[str, Any]
RIGID: Contact = {"model": "rigid_wheel_on_soil"}
BEKKER: Contact = {"model": "bekker_wheel_on_soil"}
DRY: Contact = {"model": "rigid_wheel_on_rigid_ground"}
SERIES: Contact = {"model": "wheel_and_ground_in_series", "stiffness": 40e3}
MESH: Contact = {
    "model": "compliant_wheel_on_rigid_ground", "stiffness": 5e3, "progressive_stiffness": 1e5, "stop_deflection": 0.03,
    "stop_stiffness": 5e4,
}  # fmt: skip
SOFT: Contact = {"model": "compliant_wheel_on_soil", "carcass_pressure": 3e3, "carcass_pressure_slope": 2e5}
BRUSH: Contact = {
    "model": "brush", "stiffness": 3e4, "longitudinal_stiffness": 800.0, "cornering_stiffness": 600.0,
}  # fmt: skip
MAGIC: Contact = {"model": "magic_formula", "stiffness": 3e4}
MECANUM_LEFT: Contact = {"model": "roller_wheel", "stiffness": 5e4, "roller_angle_deg": 45.0}
MECANUM_RIGHT: Contact = {**MECANUM_LEFT, "roller_angle_deg": -45.0}
OMNI: Contact = {**MECANUM_LEFT, "roller_angle_deg": 90.0}

MIXED = [BRUSH, MESH, MECANUM_LEFT, MECANUM_RIGHT, SOFT, RIGID]
ON_ROCK = {
    "dry": [DRY] * 6, "series": [SERIES] * 6, "mesh": [MESH] * 6, "brush": [BRUSH] * 6, "magic": [MAGIC] * 6,
    "mixed": MIXED,
}  # fmt: skip
ON_SOIL = {"soft": [SOFT] * 6, "bekker": [BEKKER] * 6, "mixed": MIXED}
MACHINES = [("rigid_rock", name, contacts) for name, contacts in ON_ROCK.items()]
MACHINES += [("lunar_nominal", name, contacts) for name, contacts in ON_SOIL.items()]
every_machine = pytest.mark.parametrize(
    ("ground", "contacts"),
    [(ground, contacts) for ground, _, contacts in MACHINES],
    ids=[f"{name}-{ground}" for ground, name, _ in MACHINES],
)


def with_contacts(scenario: str, contacts: list[Contact], *overrides: str) -> tuple[PlantModel, Any, Any]:
    """Model, first state and command to hold: the explorer with these models, wheel by wheel."""
    loaded = load_scenario(scenario, overrides)
    wheels = tuple(
        WheelParams.model_validate({**wheel.model_dump(), "contact": contact})
        for wheel, contact in zip(loaded.machine.wheels, contacts, strict=True)
    )
    fields = {name: getattr(loaded.machine, name) for name in MachineParams.model_fields}
    machine = MachineParams.model_validate({**fields, "wheels": wheels})
    site = Site(loaded.height_field(), list(loaded.soils.values()), loaded.gravity_field)
    model = PlantModel(loaded.urdf_xml, machine, site, loaded.power, loaded.simulation)
    start = loaded.config.start
    state = initial_state(model, start.x, start.y, start.yaw, 0.8)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    return model, state, command


def run(model: PlantModel, state: Any, command: Any, seconds: float) -> tuple[Any, Any]:
    for _ in range(round(seconds / model.simulation.control_period)):
        state, output = step(model, state, command)
    return state, output


@every_machine
def test_stands_and_drives_and_its_energies_balance(ground: str, contacts: list[Contact]) -> None:
    model, start, command = with_contacts("flat_drive", contacts, f"soil={ground}")
    weight = model.mass * model.gravity
    _, resting = run(model, start, command, 0.04)
    forces = resting.contacts[:6, 6:9]
    assert forces[:, 2].sum() == pytest.approx(weight, rel=1e-3)
    assert forces[:, 2].min() > 0.05 * weight
    drives = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    command.reference[1, drives] = 0.6
    state, output = run(model, start, command, 5.0)
    travelled = state.configuration[:2] - start.configuration[:2]
    # by the closed forms, the soil that so small a wheel pushes ahead of itself takes most of its thrust
    assert travelled[0] > (0.02 if contacts[0] is BEKKER else 0.5 * 0.6 * 0.125 * 5.0)
    assert abs(travelled[1]) < 0.1 * travelled[0]
    assert state.energy.balance_error(start.energy) < 3e-3
    assert state.energy.soil_work > 0.0
    assert np.isfinite(output.contacts).all()
    assert (output.contacts[:6, 8] > 0.0).all()


@every_machine
def test_parks_on_a_slope_without_creep(ground: str, contacts: list[Contact]) -> None:
    """Askew on a slope of 10 degrees."""
    model, start, command = with_contacts(
        "parked_slope", contacts, f"soil={ground}", "start.yaw=0.7", "terrain.slope_deg=10"
    )
    state, _ = run(model, start, command, 2.0)
    later, output = run(model, state, command, 8.0)
    assert np.linalg.norm(later.configuration[:3] - state.configuration[:3]) < 2e-5
    assert np.abs(later.velocity).max() < 1e-5
    uphill = np.array([math.cos(math.radians(10.0)), 0.0, math.sin(math.radians(10.0))])
    held = output.contacts[:, 6:9].sum(axis=0) @ uphill
    assert held == pytest.approx(model.mass * model.gravity * math.sin(math.radians(10.0)), rel=2e-3)


def test_six_omni_wheels_hold_it_along_but_not_across() -> None:
    held, start, command = with_contacts("parked_slope", [OMNI] * 6, "soil=rigid_rock", "terrain.slope_deg=5")
    state, _ = run(held, start, command, 4.0)
    assert np.linalg.norm(state.configuration[:3] - start.configuration[:3]) < 1e-3
    # set down facing across the slope it rolls away sideways, so that the start cannot settle there
    free, start, command = with_contacts("flat_drive", [OMNI] * 6, "soil=rigid_rock")
    pushed = start.copy()
    pushed.velocity[1] = 0.2
    state, _ = run(free, pushed, command, 1.0)
    assert state.velocity[1] == pytest.approx(0.2 - 0.01 * free.gravity * 1.0, abs=0.01)


def test_four_mecanum_wheels_drive_sideways() -> None:
    """The outer four on rollers in an X, the middle two on omni rollers: turned against each other, it goes left."""
    contacts = [MECANUM_RIGHT, MECANUM_LEFT, OMNI, OMNI, MECANUM_LEFT, MECANUM_RIGHT]
    model, start, command = with_contacts("flat_drive", contacts, "soil=rigid_rock")
    drives = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    command.reference[1, drives] = 0.6 * np.array([-1.0, 1.0, 0.0, 0.0, 1.0, -1.0])
    state, _ = run(model, start, command, 6.0)
    moved = state.configuration[:2] - start.configuration[:2]
    assert moved[1] > 0.5 * 0.6 * 0.125 * 6.0
    assert abs(moved[0]) < 0.1 * moved[1]


def test_the_report_tells_what_each_contact_does() -> None:
    model, start, command = with_contacts("flat_drive", MIXED, "soil=lunar_nominal")
    drives = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    command.reference[1, drives] = 0.5
    _, output = run(model, start, command, 4.0)
    brush, mesh, left, right, soft, rigid = output.contacts[:6]
    assert min(row[11] for row in (brush, mesh, left, right)) > 0.0  # deflection
    assert rigid[11] == 0.0
    assert min(row[3] for row in output.contacts[:6]) > 0.0  # sinkage
    assert soft[13] > 0.0 and soft[14] > 0.0  # compaction, bulldozing
    assert brush[12] == pytest.approx(0.01 * np.linalg.norm(brush[6:9]), rel=0.2)  # rolling resistance
    assert (output.contacts[:6, 15] > 0.0).all()  # all of them take power
    assert mesh[11] > brush[11]


def test_ground_that_lacks_what_a_wheel_needs_is_refused() -> None:
    bare = SoilParams(
        name="bare_rock", citation="test", kind="rigid", n=1.0, k_c=0.0, k_phi=5e7, friction_angle_deg=30.0,
        contact_damping=1.0,
    )  # fmt: skip
    loaded = load_scenario("flat_drive")
    ground = loaded.height_field()
    fields = {name: getattr(loaded.machine, name) for name in MachineParams.model_fields}

    def build(contacts: list[Contact]) -> PlantModel:
        wheels = tuple(
            WheelParams.model_validate({**wheel.model_dump(), "contact": contact})
            for wheel, contact in zip(loaded.machine.wheels, contacts, strict=True)
        )
        machine = MachineParams.model_validate({**fields, "wheels": wheels})
        soils = [bare.model_copy(update={"name": name}) for name in ground.soil_names]
        site = Site(ground, soils, loaded.gravity_field)
        return PlantModel(loaded.urdf_xml, machine, site, loaded.power, loaded.simulation)

    assert len(build([BRUSH, DRY, MESH, MECANUM_LEFT, MAGIC, SERIES]).wheel_names) == 6
    with pytest.raises(InvalidValueError, match=r"rear_left.*cohesion, shear_modulus, shear_modulus_lateral") as caught:
        build([BRUSH, DRY, MESH, MECANUM_LEFT, SOFT, SERIES])
    assert "compliant_wheel_on_soil" in str(caught.value)
