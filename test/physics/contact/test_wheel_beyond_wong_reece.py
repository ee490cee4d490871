"""The terms that a soil may add to Wong and Reece's wheel: bare rims, grousers, growing sinkage, pushed soil."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.wheels.wheel_bench import OverloadError, measure, slips
from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.pushed_soil import front_push, side_push
from sojourn_physics.contact.rigid_rim import Quadrature, RigidRim, RimContact, Travel
from sojourn_physics.contact.wheel_on_soil import (
    QUADRATURE,
    travel,
    turning_angle,
    wheel_forces,
)
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.bearing import bearing_factors, bulldozing_resistance
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_row

RADIUS, WIDTH = 0.058, 0.05
SMOOTH = (RADIUS, RADIUS, WIDTH, 0.0, 0.0)
LUGGED = (RADIUS, RADIUS + 0.006, WIDTH, 18.0, 0.001)
EARTH = 9.81
BARE = RigidRim(RADIUS, RADIUS, WIDTH)
_POINTS, _FINE = np.polynomial.legendre.leggauss(500)
FINE = Quadrature(0.5 * (_POINTS + 1.0), 0.5 * _FINE)


def soil(name: str = "cmu_sand", **changes: object) -> SoilParams:
    return SoilParams.model_validate({**load_params("soils", name, SoilParams).model_dump(), **changes})


SAND = kernel_row(soil())
COHESIVE = kernel_row(
    soil(
        cohesion=900.0,
        interface_adhesion=100.0,
        front_bulldozing=True,
        residual_shear_ratio=0.7,
    )
)
shapes = st.sampled_from([SMOOTH, LUGGED])
rows = st.sampled_from([SAND, COHESIVE, kernel_row(soil("ding_2011")), kernel_row(soil("kls_1"))])
sinkages = st.floats(0.0, 0.12)
unit = st.floats(-1.0, 1.0)


def forces(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float, rolling: float = 1.0
) -> FloatArray:
    return np.array(wheel_forces(RigidRim(*shape), EARTH, RimContact(z, slip, lateral, rolling), row, QUADRATURE))


@settings(max_examples=300, deadline=None)
@given(shapes, rows, sinkages, unit, unit)
def test_steady_motion_gives_no_energy(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float
) -> None:
    found = forces(shape, row, z, slip, lateral)
    rim_speed, ahead, _, _ = travel(slip, lateral)
    parts = np.array([found[3] * rim_speed / RADIUS, -found[0] * ahead, found[1] * lateral])
    assert parts.sum() >= -1e-9 * np.abs(parts).sum()
    assert found[7] >= 0.0 and found[8] >= 0.0


@settings(max_examples=300, deadline=None)
@given(shapes, rows, st.floats(-1e3, 1e3), unit, unit, st.floats(0.0, 1.0))
def test_finite(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float, rolling: float
) -> None:
    found = forces(shape, row, z, slip, lateral, rolling)
    assert np.isfinite(found).all() and found[2] >= 0.0


@settings(max_examples=300, deadline=None)
@given(shapes, rows, st.floats(0.002, 0.1), unit, st.floats(-0.999, 0.999), st.floats(0.0, 1.0), st.integers(0, 3))
def test_continuous_in_every_input(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float, rolling: float, which: int
) -> None:
    """A step of a hundred-thousandth in one input changes no force by more than a fifth of a percent."""
    given_so = [z, slip, lateral, rolling]
    there = list(given_so)
    there[which] += 1e-5 if given_so[which] < 0.5 else -1e-5
    if which == 0:
        there[0] = z * (1.0 + 1e-5)
    here, moved = forces(shape, row, *given_so), forces(shape, row, *there)
    assert np.allclose(here[:3], moved[:3], rtol=0.0, atol=2e-3 * np.linalg.norm(here[:3]) + 1e-6)


@settings(max_examples=100, deadline=None)
@given(shapes, rows, st.floats(0.002, 0.1), unit, unit)
def test_left_is_the_mirror_of_right(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float
) -> None:
    mirror = np.array([1, -1, 1, 1, -1, -1, 1, 1, 1])
    left, right = forces(shape, row, z, slip, lateral), forces(shape, row, z, slip, -lateral)
    assert np.allclose(left * mirror, right, rtol=0.0, atol=1e-12 * np.abs(left).max() + 1e-15)


@settings(max_examples=100, deadline=None)
@given(shapes, rows, st.floats(0.002, 0.045), unit, unit)  # sunk to the axle it is 0.5 %
def test_quadrature_is_within_a_tenth_of_a_percent(
    shape: tuple[float, ...], row: FloatArray, z: float, slip: float, lateral: float
) -> None:
    given_so = (RigidRim(*shape), EARTH, RimContact(z, slip, lateral, 1.0), row)
    fine = np.array(wheel_forces(*given_so, FINE)[:3])
    # Deep in skid, on sand that shears within 4 mm, the stress turns more sharply than six points follow; so does the
    # peak of an invented soil with a hump on such sand, in full sideslip (0.15 %).
    error = 3e-3 if slip < 0.0 else 1e-3 if row[SoilColumn.HUMP] == 0.0 else 2e-3
    assert np.linalg.norm(forces(shape, row, z, slip, lateral)[:3] - fine) <= error * np.linalg.norm(fine)


@settings(max_examples=200, deadline=None)
@given(unit, st.floats(-math.pi / 2, math.pi / 2))
def test_motion_is_found_again_from_the_slips(slip: float, angle: float) -> None:
    rim, speed = 1.0 + min(slip, 0.0), 1.0 - max(slip, 0.0)
    along, lateral = slips(slip, angle)
    rim_speed, ahead, total_slip, sideways = travel(along, lateral)
    assert (rim_speed, ahead) == pytest.approx((rim, speed * math.cos(angle)), abs=1e-7)
    assert total_slip == pytest.approx(slip, abs=1e-7)
    expected = speed * (1.0 - math.cos(angle)) / math.hypot(speed, 0.01)
    assert sideways == pytest.approx(expected, abs=1e-6)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.1, 1.5), st.floats(-0.99, -0.01), st.floats(-0.1, 0.0))
@example(entry=1.0, slip=-0.0625, shift=-0.09375)
def test_turning_angle_is_where_the_shear_turns(entry: float, slip: float, shift: float) -> None:
    turn = turning_angle(entry, slip, shift)
    behind = -math.acos(1.0 + slip)  # further back it would turn again
    theta = np.linspace(behind, entry, 20001)[:-1]
    shear = (1.0 + slip) * (entry - theta) - (math.sin(entry) - np.sin(theta)) + shift
    ahead = theta[shear > 1e-9]
    if math.isinf(turn):
        assert len(ahead) == 0 or shear[0] > -1e-9  # none of it is ahead, or all
    elif shear[0] < 0.0:
        assert abs(turn - ahead.min()) < 5e-3


def test_sinkage_grows_by_the_stated_factor() -> None:
    """The pressure of a plain soil at z is that of a soil that slips at S z: at slip 0.5, S = 1 + 2 x 0.5."""
    straight = dict(side_sinkage=0.0, skid_sinkage=0.0, theta_m_c2=0.0)
    plain = kernel_row(soil(slip_sinkage=0.0, **straight))
    slipping = kernel_row(soil(slip_sinkage=2.0, **straight))
    e = travel(0.5, 0.0)[3]
    factor = (1.0 + (1.0 - e) * 2.0 * 0.5) ** -1.46
    weaker = plain.copy()
    weaker[SoilColumn.K_PHI] *= factor
    here = forces(SMOOTH, slipping, 0.02, 0.5, 0.0)
    assert np.allclose(here, forces(SMOOTH, weaker, 0.02, 0.5, 0.0), rtol=1e-12)


@pytest.mark.parametrize(("name", "wheel_name"), [("cmu_sand", "pavlov_smooth"), ("ding_2011",) * 2, ("kls_1",) * 2])
def test_slip_sinkage_goes_on_up_to_spinning_on_the_spot(name: str, wheel_name: str) -> None:
    """From 0.9 to 1 the sinkage neither falls back nor doubles, at any slip angle that is driven."""
    wheel = load_params("wheels", wheel_name, WheelShape)
    at = [0.8, 0.9, 0.95, 0.98, 1.0]
    straight = [one.sinkage_m for one in measure(wheel, soil(name), 25.0, at)]
    assert straight == sorted(straight)
    assert straight[-1] - straight[1] < 3.0 * (straight[1] - straight[0])
    spinning = measure(wheel, soil(name), 25.0, [1.0], [0.0, 45.0, 90.0])
    assert len({(one.sinkage_m, one.drawbar_pull_n) for one in spinning}) == 1  # it goes nowhere


@pytest.mark.parametrize("name", ["lunar_nominal", "clayey_soil"])
def test_front_push_is_the_bulldozing_resistance(name: str) -> None:
    params = soil(name, front_bulldozing=True)
    unit_weight = params.unit_weight(1.624)
    for z in (0.001, 0.02, 0.1):
        expected = bulldozing_resistance(params.friction_angle, params.cohesion, unit_weight, 0.229, 0.813, z)
        assert front_push(0.4065, 0.229, 1.624, z, kernel_row(params)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.published
def test_published_bulldozing_resistance_comes_out_of_the_wheel() -> None:
    """Lunar roving vehicle: 89.19 N at 17.04 mm, phi 33 deg, c 170 Pa, gamma 2470 N/m3."""
    params = soil("lunar_nominal", friction_angle_deg=33.0, front_bulldozing=True, density=2470.0 / 1.624)
    rim, contact = RigidRim(0.4065, 0.4065, 0.229), RimContact(0.01704, 0.1)
    found = wheel_forces(rim, 1.624, contact, kernel_row(params), QUADRATURE)
    plain = kernel_row(params.model_copy(update={"front_bulldozing": False}))
    without = wheel_forces(rim, 1.624, contact, plain, QUADRATURE)
    assert found[8] == pytest.approx(89.19, rel=2e-3) and without[8] == 0.0
    assert without[0] - found[0] == pytest.approx(found[8])


@settings(max_examples=50, deadline=None)
@given(st.floats(0.001, 0.09))
def test_side_push_is_the_integral_over_the_sunk_segment(z: float) -> None:
    params = soil(cohesion=300.0)
    phi, c = math.atan(2.0 / 3.0 * math.tan(math.radians(29.0))), 200.0
    factors = bearing_factors(phi)
    half = math.sqrt(RADIUS**2 - max(RADIUS - z, 0.0) ** 2)

    def wall(x: float) -> float:
        h = math.sqrt(max(RADIUS**2 - x * x, 0.0)) - (RADIUS - z)
        return 0.5 * 1330.0 * EARTH * factors.k_gamma * h * h + c * factors.k_c * h

    full = 2.0 * quad(wall, 0.0, half, epsrel=1e-9)[0]
    # locked, straight to the right: far more than the displacement that mobilises it
    found = side_push(BARE, EARTH, RimContact(z, 0.0, 1.0), Travel(0.0, 0.0, 0.0, 1.0), 0.1, kernel_row(params))
    assert found[0] == 0.0 and found[2] == 0.0  # nothing slides along the face
    assert found[1] == pytest.approx(full, rel=1e-6)
    turning = side_push(BARE, EARTH, RimContact(z, 0.0, 1.0), Travel(1.0, 0.0, 0.0, 1.0), 0.1, kernel_row(params))
    assert 0.0 < turning[0] < full * math.tan(math.radians(23.2))  # the face drags the wheel ahead
    assert turning[2] == pytest.approx(turning[0] * (RADIUS - 0.5 * min(z, RADIUS)))


def test_bench_finds_the_load_and_refuses_nonsense() -> None:
    wheel = load_params("wheels", "pavlov_smooth", WheelShape)
    (one,) = measure(wheel, soil(), 24.0, [0.2], [30.0])
    along, lateral = slips(0.2, math.radians(30.0))
    found = forces(SMOOTH, SAND, one.sinkage_m, along, lateral)
    assert found[2] == pytest.approx(24.0, rel=1e-9)
    assert (one.drawbar_pull_n, one.side_force_n) == pytest.approx((found[0], found[1]), rel=2e-3)  # g 9.80665
    with pytest.raises(OverloadError, match="does not carry"):
        measure(wheel, soil(), 1e6, [0.2])
    for load, slip, angle in ((0.0, 0.1, 0.0), (math.nan, 0.1, 0.0), (1.0, 1.1, 0.0), (1.0, 0.1, 91.0)):
        with pytest.raises(InvalidValueError):
            measure(wheel, soil(), load, [slip], [angle])


@pytest.mark.parametrize("lateral", [1e-170, -5e-324])
def test_push_is_finite_where_the_face_hardly_slides(lateral: float) -> None:
    """The middle of the face stands still in the soil, and the sideslip is too small to be squared."""
    sinkage = 0.02
    ahead = 1.0 * (RADIUS - 0.5 * sinkage) / RADIUS
    found = side_push(BARE, EARTH, RimContact(sinkage, 0.0, lateral), Travel(1.0, ahead, 0.0, 0.0), 0.05, SAND)
    assert all(math.isfinite(x) and abs(x) < 1e-100 for x in found)
