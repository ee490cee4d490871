"""A lander on three feet: what it weighs, how deep it stands, and that it stays where it was put down."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_config.scenario import load_scenario
from sojourn_machine.contact_report import FORCE, PLACE, ReportColumn
from sojourn_machine.drives import JointFrictionParams
from sojourn_machine.machine import MachineParams
from sojourn_machine.supports import FootParams, PadParams
from sojourn_physics.contact.foot_pad import pad_pressure
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_physics.soil.params import SoilColumn, kernel_row

MASS, RADIUS, SPREAD, HEIGHT = 90.0, 0.12, 0.8, 0.5
URDF = f"""<robot name="lander">
  <link name="base_link"><inertial><origin xyz="0 0 0"/><mass value="{MASS}"/>
    <inertia ixx="8" iyy="8" izz="10" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
NO_FRICTION = JointFrictionParams(friction_torque=0.0, viscous_friction=0.0)


def feet(**changes: object) -> tuple[FootParams, ...]:
    found = []
    for number, angle in enumerate(np.radians([0.0, 120.0, 240.0])):
        place = (SPREAD * math.cos(angle), SPREAD * math.sin(angle), -HEIGHT)
        given = {"name": f"foot_{number}", "link": "base_link", "position": place, "radius": RADIUS}
        found.append(FootParams.model_validate({**given, **changes}))
    return tuple(found)


def lander(scenario: str, *overrides: str, **changes: object) -> tuple[PlantModel, PlantState]:
    loaded = load_scenario(scenario, overrides)
    pad = PadParams(name="belly", link="base_link", position=(0.0, 0.0, -0.2), radius=0.05)
    machine = MachineParams(feet=feet(**changes), pads=(pad,), passive_joint=NO_FRICTION)
    site = Site(loaded.height_field(), list(loaded.soils.values()), loaded.gravity_field)
    model = PlantModel(URDF, machine, site, loaded.power, loaded.simulation)
    start = loaded.config.start
    return model, initial_state(model, start.x, start.y, start.yaw, 0.8)


def test_it_stands_as_deep_as_the_law_says_of_its_weight() -> None:
    model, state = lander("flat_drive")
    _, output = step(model, state, zeros_command(0, len(model.loads)))
    forces = output.contacts[:3, FORCE]
    assert forces[:, 2].sum() == pytest.approx(MASS * model.gravity, rel=1e-4)
    assert forces[:, 2] == pytest.approx([MASS * model.gravity / 3.0] * 3, rel=1e-3)
    assert not output.contacts[3, FORCE].any(), "the belly touches the ground"
    soil = kernel_row(load_scenario("flat_drive").soil)
    for depth, load in zip(output.contacts[:3, ReportColumn.SINKAGE], forces[:, 2], strict=True):
        pressure = pad_pressure(RADIUS, depth, soil, soil[SoilColumn.DENSITY] * model.gravity)
        assert math.pi * RADIUS**2 * pressure == pytest.approx(load, rel=1e-3)
        assert depth > 0.0


def test_parked_on_a_slope_it_does_not_creep() -> None:
    model, state = lander("parked_slope", "terrain.slope_deg=10")
    command = zeros_command(0, len(model.loads))
    start = state.configuration[:3].copy()
    for _ in range(500):
        state, output = step(model, state, command)
    assert np.linalg.norm(state.configuration[:3] - start) < 1e-5
    up, away = output.contacts[:3, FORCE].sum(axis=0)[2], output.contacts[:3, FORCE].sum(axis=0)[:2]
    assert up == pytest.approx(MASS * model.gravity, rel=1e-4)
    assert np.abs(away).max() < 1e-3 * up
    assert np.ptp(output.contacts[:3, PLACE][:, 2]) > 0.05


def test_dropped_it_comes_to_rest_and_no_energy_is_made() -> None:
    model, state = lander("flat_drive")
    lifted = state.copy()
    lifted.configuration[2] += 0.1
    lifted.supports.feet[:] = 0.0
    command, highest = zeros_command(0, len(model.loads)), []
    for _ in range(200):
        lifted, _ = step(model, lifted, command)
        highest.append(lifted.configuration[2])
    assert max(highest) <= state.configuration[2] + 0.1 + 1e-9
    assert highest[-1] < state.configuration[2] + 1e-3
    assert np.abs(lifted.velocity).max() < 0.01


def test_a_foot_has_a_law_of_a_foot() -> None:
    with pytest.raises(ValidationError, match=r"contact model of a foot.*foot_pad"):
        feet(contact={"model": "rigid_wheel_on_soil"})
