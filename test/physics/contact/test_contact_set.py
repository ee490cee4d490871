"""Wheels on their ground: the contact plane, symmetry, dissipation, rest, edges."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_physics.contact.ground_plane import blend_soils
from sojourn_physics.contact.rigid_rim import RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, pressure_modulus, rim_forces
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.height_field import sample_height

Maker = Callable[..., Any]
Turn = Callable[[str, float], FloatArray]
ZERO = np.zeros(3)
RADIUS = 0.125
slopes = st.floats(-0.4, 0.4)
yaws = st.floats(-math.pi, math.pi)


def centre_over(rig: Any, rotation: FloatArray, sinkage: float) -> FloatArray:
    """Centre of a wheel whose rim is `sinkage` under the plane through the map's origin."""
    camber = float(rotation[:, 1] @ rig.normal)
    return np.asarray(rig.normal * (RADIUS * math.sqrt(1.0 - camber**2) - sinkage))


@settings(max_examples=60, deadline=None)
@given(slopes, slopes, yaws, st.floats(-0.6, 0.6), st.floats(-0.5, 0.5), st.floats(0.0005, 0.03))
def test_the_contact_plane_is_exact_on_tilted_planes(
    rig: Maker, rotation: Turn, sx: float, sy: float, yaw: float, roll: float, pitch: float, depth: float
) -> None:
    one = rig("lunar_nominal", slope_x=sx, slope_y=sy)
    attitude = rotation("z", yaw) @ rotation("x", roll) @ rotation("y", pitch)
    force, moment = one.push(centre_over(one, attitude, depth), attitude, ZERO, ZERO)
    assert one.report[0, 3] == pytest.approx(depth, abs=1e-12)
    # at rest and never moved there is no shear: the force is the static one, along the normal
    static = rim_forces(RADIUS, 0.131, 0.16, RimContact(depth, 0.0, 0.0, 0.0), one.soils[0], QUADRATURE)[2]
    assert np.allclose(force, static * one.normal, atol=1e-9 * static)
    # and acts at the lowest point of the rim, which lies in the plane, `depth` below it
    lowest = one.report[0, :3]
    assert lowest @ one.normal == pytest.approx(-depth, abs=1e-12)
    centre = centre_over(one, attitude, depth)
    assert np.allclose(moment, np.cross(lowest - centre, force), atol=1e-9 * static)


@settings(max_examples=12, deadline=None)
@given(slopes, slopes, yaws, st.floats(-0.3, 0.3), st.floats(-0.5, 2.0), st.floats(-0.05, 0.05))
def test_a_wheel_on_a_slope_is_the_wheel_on_the_flat_turned(
    rig: Maker, rotation: Turn, sx: float, sy: float, yaw: float, roll: float, spin: float, aside: float
) -> None:
    flat, tilted = rig("ishigami_2007"), rig("ishigami_2007", slope_x=sx, slope_y=sy)
    # rotation that takes up to the tilted normal
    axis = np.cross([0.0, 0.0, 1.0], tilted.normal)
    cosine = float(tilted.normal[2])
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + cross + cross @ cross / (1.0 + cosine)
    attitude = rotation("z", yaw) @ rotation("x", roll)
    velocity = rotation("z", yaw) @ np.array([0.1, aside, 0.0])
    angular = spin * attitude[:, 1]
    centre = centre_over(flat, attitude, 0.015)
    force, moment = flat.hold(centre, attitude, velocity, angular, 400)
    turned_force, turned_moment = tilted.hold(turn @ centre, turn @ attitude, turn @ velocity, turn @ angular, 400)
    assert np.allclose(turned_force, turn @ force, atol=1e-8 * np.abs(force).max())
    assert np.allclose(turned_moment, turn @ moment, atol=1e-8 * np.abs(force).max())
    assert np.allclose(tilted.report[0, 3:6], flat.report[0, 3:6], atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.2, 0.2), st.floats(-2.0, 2.0), st.floats(-0.1, 0.1))
def test_travel_reversed_is_mirrored(rig: Maker, speed: float, spin: float, aside: float) -> None:
    ahead, back = rig("lunar_nominal"), rig("lunar_nominal")
    centre = np.array([0.0, 0.0, RADIUS - 0.012])
    axle = np.array([0.0, 1.0, 0.0])
    force, moment = ahead.hold(centre, np.eye(3), np.array([speed, aside, 0.0]), spin * axle, 600)
    mirrored, mirrored_moment = back.hold(centre, np.eye(3), np.array([-speed, aside, 0.0]), -spin * axle, 600)
    assert np.allclose(mirrored, force * [-1, 1, 1], atol=1e-9 * force[2])
    assert np.allclose(mirrored_moment, moment * [1, -1, -1], atol=1e-9 * force[2])
    # slip ratio and slip angle are told in the sense of travel
    assert np.allclose(back.report[0, 3:6], ahead.report[0, 3:6], atol=1e-12)


@pytest.mark.parametrize(("speed", "spin"), [(0.1, 1.0), (0.1, 0.7), (0.05, 2.0), (0.1, 0.0), (-0.1, -1.2)])
def test_steady_rolling_has_the_usual_slip_ratio(rig: Maker, speed: float, spin: float) -> None:
    one = rig("lunar_nominal")
    one.hold(
        np.array([0.0, 0.0, RADIUS - 0.012]),
        np.eye(3),
        np.array([speed, 0.02, 0.0]),
        np.array([0.0, spin, 0.0]),
    )
    rim_speed = RADIUS * spin
    slip = (rim_speed - speed) / max(abs(rim_speed), abs(speed)) * math.copysign(1.0, speed)
    assert one.report[0, 4] == pytest.approx(slip, abs=1e-9)
    assert one.report[0, 5] == pytest.approx(math.atan2(0.02, abs(speed)), abs=1e-9)
    # the memory of the direction of travel fills up over some lengths of contact
    assert 0.9 < one.state[0, 2] * math.copysign(1.0, speed) <= 1.0


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["lunar_nominal", "jsc_1a", "rigid_rock", "snow", "lean_clay", "ishigami_2007"]),
    st.floats(-0.2, 0.2),
    st.floats(-2.0, 2.0),
    st.floats(-0.2, 0.2),
    st.floats(0.001, 0.02),
)
def test_steady_motion_never_takes_energy_from_the_ground(
    rig: Maker, soil: str, speed: float, spin: float, aside: float, depth: float
) -> None:
    one = rig(soil)
    if max(abs(speed), abs(RADIUS * spin), abs(aside)) < 0.01:
        return  # steady only after many seconds
    velocity, angular = np.array([speed, aside, 0.0]), np.array([0.0, spin, 0.0])
    force, moment = one.hold(np.array([0.0, 0.0, RADIUS - depth]), np.eye(3), velocity, angular, 1500)
    power = -(force @ velocity + moment @ angular)
    assert power >= -1e-9 * abs(force[2])


@pytest.mark.parametrize(
    ("soil", "depth"),
    [("lunar_nominal", 0.01), ("jsc_1a", 0.01), ("snow", 0.01), ("lean_clay", 0.001), ("rigid_rock", 0.0002)],
)
@pytest.mark.parametrize("turning", [0.0, 0.9, 1.1])
@pytest.mark.parametrize("phase", [0.0, 1.5])
@pytest.mark.parametrize("amplitude", [2e-4, 0.02])
def test_rocking_to_and_fro_costs_work(
    rig: Maker, soil: str, depth: float, turning: float, phase: float, amplitude: float
) -> None:
    """Turning to and fro `turning` times as far as it travels, `phase` apart: a swing takes no energy."""
    one = rig(soil, dt=0.004)
    centre = np.array([0.0, 0.0, RADIUS - depth])
    rate = 1.5
    period = round(2.0 * math.pi / rate / one.dt)
    for _ in range(2):
        work = 0.0
        moved = 0.0
        for k in range(period):
            angle = 2.0 * math.pi * (k + 0.5) / period
            velocity = np.array([amplitude * rate * math.cos(angle), 0.0, 0.0])
            angular = np.array([0.0, turning * amplitude / RADIUS * rate * math.cos(angle + phase), 0.0])
            force, moment = one.push(centre, np.eye(3), velocity, angular)
            power = -(force @ velocity + moment @ angular)
            work += power * one.dt
            moved += abs(power) * one.dt
    assert work >= -0.02 * moved


def test_normal_force_is_conservative_in_height_and_camber(rig: Maker, rotation: Turn) -> None:
    """Quasi-static closed path in (camber, height), no damping: no net work."""
    one = rig("lunar_nominal", damping=0.0)
    corners = [(0.0, 0.115), (0.35, 0.115), (0.35, 0.108), (0.0, 0.108), (0.0, 0.115)]
    work = 0.0
    largest = 0.0
    for (camber_1, height_1), (camber_2, height_2) in pairwise(corners):
        points = 400
        for k in range(points):
            part = (k + 0.5) / points
            camber = camber_1 + part * (camber_2 - camber_1)
            height = height_1 + part * (height_2 - height_1)
            force, moment = one.push(np.array([0.0, 0.0, height]), rotation("x", camber), ZERO, ZERO)
            side = force[2] * (height_2 - height_1) + moment[0] * (camber_2 - camber_1)
            work += side / points
            largest = max(largest, abs(side))
    assert abs(work) < 1e-5 * largest


def test_a_wheel_at_rest_keeps_its_shear_for_ever(rig: Maker) -> None:
    one = rig("lunar_nominal")
    centre = np.array([0.0, 0.0, RADIUS - 0.01])
    one.hold(centre, np.eye(3), np.array([0.01, 0.005, 0.0]), ZERO, 200)
    force, _ = one.push(centre, np.eye(3), ZERO, ZERO)
    state = one.state.copy()
    later, _ = one.hold(centre, np.eye(3), ZERO, ZERO, 5000)
    assert force[0] < -1.0
    assert np.array_equal(one.state, state)
    assert np.array_equal(later, force)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_forces_are_continuous_where_the_sense_of_travel_turns(rig: Maker, shear: float, aside: float) -> None:
    centre = np.array([0.0, 0.0, RADIUS - 0.015])
    results = []
    for direction in (-1e-9, 1e-9):
        one = rig("jsc_1a")
        one.state[0, :3] = [shear, aside, direction]
        results.append(np.concatenate(one.push(centre, np.eye(3), ZERO, ZERO)))
    assert np.allclose(results[0], results[1], atol=1e-6 * np.abs(results[0]).max())


def test_damping_resists_both_ways_and_never_pulls(rig: Maker) -> None:
    centre = np.array([0.0, 0.0, RADIUS - 0.01])
    loads = []
    for vertical in (-0.5, -0.1, 0.0, 0.1, 0.5, 5.0):
        one = rig("lunar_nominal")
        loads.append(one.push(centre, np.eye(3), np.array([0.0, 0.0, vertical]), ZERO)[0][2])
    static = loads[2]
    assert loads[1] == pytest.approx(1.5 * static)  # d = 5 s/m
    assert loads[3] == pytest.approx(0.5 * static)
    assert loads[0] == pytest.approx(3.0 * static)  # the largest gain
    assert loads[5] == 0.0


def test_a_wheel_in_the_air_forgets(rig: Maker) -> None:
    one = rig("lunar_nominal")
    one.state[0, :3] = [0.01, 0.02, 0.5]
    force, moment = one.push(np.array([0.0, 0.0, 0.2]), np.eye(3), ZERO, ZERO)
    assert not force.any() and not moment.any() and not one.state.any()
    assert one.on_map


def test_a_wheel_that_has_left_the_map_is_told(rig: Maker) -> None:
    one = rig("lunar_nominal")
    one.push(np.array([9.99, 0.0, RADIUS - 0.01]), np.eye(3), ZERO, ZERO)
    assert not one.on_map
    force, _ = one.push(np.array([30.0, 0.0, RADIUS - 0.01]), np.eye(3), ZERO, ZERO)
    assert not one.on_map
    assert np.isfinite(force).all()
    one.push(np.array([0.0, 0.0, RADIUS - 0.01]), np.eye(3), ZERO, ZERO)
    assert one.on_map


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.floats(-2.0, 2.0),
    st.floats(-4.0, 4.0),
)
def test_finite_for_any_motion_and_attitude(
    rig: Maker, rotation: Turn, velocity: list[float], angular: list[float], height: float, roll: float
) -> None:
    one = rig("lunar_nominal", "rigid_rock", step=0.3, soil_where_positive_x=1)
    attitude = rotation("x", roll) @ rotation("z", 0.3)
    for _ in range(3):
        force, moment = one.push(np.array([-0.05, 0.0, height]), attitude, np.array(velocity), np.array(angular))
        assert np.isfinite(force).all() and np.isfinite(moment).all()
        assert np.isfinite(one.state).all() and np.isfinite(one.report).all()
        assert abs(one.state[0, 2]) <= 1.0


@pytest.mark.parametrize("soil", ["lunar_nominal", "rigid_rock"])
@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_climbing_a_step_turns_the_contact_plane(rig: Maker, rotation: Turn, soil: str, yaw: float) -> None:
    """A wheel moved onto a step of 2 cm in one cell of the grid: the force leans back, and changes little by little,
    though the gradient of the ground jumps under it."""
    one = rig(soil, step=0.02)
    height = 0.12 if soil == "lunar_nominal" else 0.1248
    forces = []
    for x in np.arange(-0.25, 0.15, 0.0005):
        one.state[:] = 0.0
        forces.append(one.push(np.array([x, 0.0, height]), rotation("z", yaw), ZERO, ZERO)[0])
    changes = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    largest = np.linalg.norm(forces, axis=1).max()
    assert min(force[0] for force in forces) < -0.1 * largest  # the step pushes back
    assert changes.max() < 0.015 * largest


def test_rolling_along_an_edge_and_off_it_is_continuous(rig: Maker, rotation: Turn) -> None:
    """A wheel shifted sideways over the edge of a step, on which it stands at last."""
    one = rig("lunar_nominal", step=0.02)
    forces = []
    for x in np.arange(-0.15, 0.1, 0.00025):
        one.state[:] = 0.0
        forces.append(one.push(np.array([x, 0.0, 0.135]), rotation("z", math.pi / 2.0), ZERO, ZERO)[0])
    changes = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    assert changes.max() < 0.02 * np.linalg.norm(forces, axis=1).max()
    assert forces[0][2] == 0.0 and forces[-1][2] > 0.0


def test_soils_under_one_wheel_are_blended_by_their_shares(rig: Maker) -> None:
    soils = rig("lunar_nominal", "rigid_rock").soils
    blended = np.empty(soils.shape[1])
    assert blend_soils(soils, np.array([2.0, 0.0]), 0.16, blended) == 0
    assert np.array_equal(blended, soils[0])
    assert blend_soils(soils, np.array([1.0, 3.0]), 0.16, blended) == 1
    moduli = [pressure_modulus(row, 0.16) for row in soils]
    assert pressure_modulus(blended, 0.16) == pytest.approx(moduli[0] ** 0.25 * moduli[1] ** 0.75)
    assert blended[SoilColumn.COHESION] == pytest.approx(0.25 * 170.0)
    # "exit angle zero" counts as lambda 0
    assert blended[SoilColumn.EXIT_LAMBDA] == pytest.approx(0.75)
    # nearly all of one soil is nearly that soil
    blend_soils(soils, np.array([1e-9, 1.0]), 0.16, blended)
    assert np.all(abs(blended - soils[1])[1:] <= 1e-6 * abs(soils[1, 1:]) + 2e-9 * abs(soils[0, 1:]))


def rim_depth(one: Any, centre: FloatArray, yaw: float) -> float:
    """How far the rim of an upright wheel is under the ground at most, measured vertically [m]."""
    angles = np.linspace(-1.5, 1.5, 3001)
    x = centre[0] + RADIUS * np.sin(angles) * math.cos(yaw)
    y = centre[1] + RADIUS * np.sin(angles) * math.sin(yaw)
    ground = [sample_height(one.heights, -10.0, -10.0, 0.05, *place)[0] for place in zip(x, y, strict=True)]
    return float(np.max(np.array(ground) - centre[2] + RADIUS * np.cos(angles)))


@settings(max_examples=200, deadline=None)
@given(
    st.lists(st.floats(0.0, 0.08), min_size=25, max_size=25),
    st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
    yaws,
    st.floats(-0.003, 0.02),
)
def test_no_wheel_is_deeper_than_its_rim_is_under_the_ground(
    rig: Maker, rotation: Turn, stones: list[float], place: tuple[float, float], yaw: float, depth: float
) -> None:
    """On stones of one node and grooves between them, of any height, to a twentieth of the radius: between two samples
    of the rim, 13 over 155 degrees, it may be deeper by 0.6 %, and by 1.5 % where its edges stand on others. A plane
    through a crest that one sample touched cut 73 mm deep where the ground did not reach the rim yet, and its 76 kN
    threw a rover over."""
    one = rig("rigid_rock")
    one.heights[198:203, 198:203] = np.array(stones).reshape(5, 5)
    centre = np.array([*place, RADIUS + max(stones)])
    centre[2] += rim_depth(one, centre, yaw) - depth
    one.push(centre, rotation("z", yaw), ZERO, ZERO)
    assert one.report[0, 3] <= max(depth, 0.0) + 0.05 * RADIUS


@pytest.mark.parametrize("height", [0.02, 0.04])
@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_a_wheel_that_brushes_a_stone_feels_it_little_by_little(
    rig: Maker, rotation: Turn, height: float, yaw: float
) -> None:
    """Over a stone of one node, as high over the ground that one or two samples touch it: nothing jumps where the
    gradient under a sample does."""
    one = rig("rigid_rock")
    one.heights[200, 200] = height
    forces = []
    for x in np.arange(-0.2, 0.2, 0.0001):
        one.state[:] = 0.0
        forces.append(one.push(np.array([x, 0.0, RADIUS + height - 0.003]), rotation("z", yaw), ZERO, ZERO)[0])
    changes = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    largest = np.linalg.norm(forces, axis=1).max()
    pressed = RimContact(0.003 + 0.0064 * RADIUS, 0.0, 0.0, 0.0)
    assert largest < rim_forces(RADIUS, 0.131, 0.16, pressed, one.soils[0], QUADRATURE)[2]
    assert changes.max() < 0.5 * largest
