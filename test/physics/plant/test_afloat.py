"""A machine that floats in orbit: its forces against those on a cloud of points, its way against the closed form."""

import math
from functools import lru_cache

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.tide import TidalField
from sojourn_physics.environment.orbit.relative_motion import transition
from sojourn_physics.plant.afloat import AfloatStart, afloat_state
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.orbital_bias import orbital_bias
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step

HILL = np.array([2, 0, 1])
"""Axes of map in the order of `transition`: outward, along the flight, along the pole."""


@lru_cache
def craft() -> PlantModel:
    scenario = load_scenario("servicer_course")
    site = Site(scenario.height_field(), list(scenario.soils.values()), scenario.gravity_field)
    simulation = SimulationParams(physics_step=0.005, control_period=1.0)
    return PlantModel(scenario.urdf_xml, scenario.machine, site, scenario.power, simulation)


def orbit() -> TidalField:
    assert craft().tide is not None
    return craft().tide


def points_of(inertia: pin.Inertia) -> list[tuple[float, FloatArray]]:
    """Six points with the mass, centre and second moments of a body: masses [kg], places in its frame [m]."""
    second = 0.5 * np.trace(inertia.inertia) * np.eye(3) - inertia.inertia  # sum of m r r^T about the centre
    values, axes = np.linalg.eigh(second)
    share = inertia.mass / 6.0
    found = []
    for value, axis in zip(values, axes.T, strict=True):
        reach = math.sqrt(value / (2.0 * share))
        found += [(share, inertia.lever + sign * reach * axis) for sign in (-1.0, 1.0)]
    return found


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**31))
def test_its_base_feels_what_a_cloud_of_points_feels_in_an_orbit(seed: int) -> None:
    model, draw = craft(), np.random.default_rng(seed)
    multibody = model.multibody.copy()
    for place, inertia in enumerate(list(multibody.inertias)):  # bodies that points can stand for
        side = np.diag(draw.uniform(0.1, 0.4, 3) * (inertia.mass + 1.0))
        multibody.inertias[place] = pin.Inertia(inertia.mass + 1.0, inertia.lever, np.trace(side) * np.eye(3) - side)
    q = pin.integrate(multibody, pin.neutral(multibody), draw.uniform(-1.0, 1.0, multibody.nv) * 2.0)
    v = draw.uniform(-1.0, 1.0, multibody.nv) * np.repeat([0.5, 0.02, 0.3], [3, 3, multibody.nv - 6])
    fast = TidalField(0.05)  # so that what is of second order shows
    data = multibody.createData()
    multibody.gravity.linear = np.zeros(3)
    alone = pin.nonLinearEffects(multibody, data, q, v).copy()
    pin.forwardKinematics(multibody, data, q, v)
    pushed = np.zeros(multibody.nv)
    for joint in range(1, multibody.njoints):
        jacobian = pin.computeJointJacobian(multibody, multibody.createData(), q, joint)
        rotation, origin = data.oMi[joint].rotation, data.oMi[joint].translation
        for mass, place in points_of(multibody.inertias[joint]):
            arm = rotation @ place
            moved = rotation @ (jacobian[:3] - pin.skew(place) @ jacobian[3:])
            pushed += moved.T @ (mass * fast.acceleration(origin + arm, moved @ v))

    pin.crba(multibody, data, q, pin.Convention.WORLD)
    composite = np.trace(data.oYcrb[1].inertia)
    found = alone - orbital_bias(multibody, data, fast, q, v)
    np.testing.assert_allclose(found[:6], pushed[:6], atol=1e-9 * np.abs(pushed).max())
    # on the joints all but the tide within the machine, which is of the size of its gravity gradient
    assert np.abs(found[6:] - pushed[6:]).max() < 3.0 * fast.rate**2 * composite


def drifted(start: AfloatStart, seconds: int) -> tuple[FloatArray, FloatArray]:
    """Place and velocity of the centre of mass in the order of `transition`, before and after, each (6,)."""
    model = craft()
    state = afloat_state(model, start, 0.8, {})
    command = zeros_command(len(model.joints.names), len(model.loads))
    seen = []
    for second in range(seconds + 1):
        if second in (0, seconds):
            data = model.multibody.createData()
            pin.centerOfMass(model.multibody, data, state.configuration, state.velocity)
            seen.append(np.concatenate([data.com[0][HILL], data.vcom[0][HILL]]))
        state, _ = step(model, state, command)
    return seen[0], seen[1]


def test_its_centre_of_mass_drifts_by_clohessy_and_wiltshire() -> None:
    before, after = drifted(AfloatStart((120.0, 80.0, -60.0), 0.7, (0.3, -0.2, 0.1), (0.0, 0.0, 0.0)), 240)
    expected = transition(orbit().rate, 240.0) @ before
    straight = before[:3] + 240.0 * before[3:]
    assert np.linalg.norm(expected[:3] - straight) > 10.0
    np.testing.assert_allclose(after[:3], expected[:3], atol=2e-3 * np.linalg.norm(expected[:3] - straight))
    np.testing.assert_allclose(after[3:], expected[3:], atol=2e-4)


def test_gravity_in_the_map_of_an_orbit_is_that_of_the_closed_form() -> None:
    field, h = TidalField(0.0011), 1e-3
    place, velocity = np.array((3.0, -4.0, 5.0)), np.array((0.1, 0.2, -0.3))
    start = np.concatenate([place[HILL], velocity[HILL]])
    found = (transition(field.rate, h) @ start - transition(field.rate, -h) @ start)[3:] / (2.0 * h)
    np.testing.assert_allclose(field.acceleration(place, velocity)[HILL], found, atol=1e-12)
    gradient = [
        (field.potential(place + 0.5 * axis) - field.potential(place - 0.5 * axis)) for axis in np.eye(3)
    ]  # exact of a square
    np.testing.assert_allclose(field.acceleration(place), -np.array(gradient), atol=1e-15)
    assert field.gravity == 0.0 and not field.escapes(place, velocity)


def test_a_body_that_is_no_orbit_has_no_such_map() -> None:
    with pytest.raises(InvalidValueError, match="an orbit"):
        load_scenario("flat_drive").body.field_in_orbit()
