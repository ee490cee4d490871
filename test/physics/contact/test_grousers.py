"""Grousers: strength between them by hand, Coulomb's bound on the pull, the soil they dig, and their limits."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from sojourn_analysis.wheels.wheel_bench import measure
from sojourn_config.load import load_params
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.grousers import dug_depth, shear_strength
from sojourn_physics.contact.rigid_rim import RigidRim, RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, contact_angles, travel, wheel_forces
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_row

RADIUS, WIDTH, EARTH = 0.125, 0.16, 9.81


def soil(name: str = "cmu_sand", **changes: object) -> SoilParams:
    return SoilParams.model_validate({**load_params("soils", name, SoilParams).model_dump(), **changes})


@st.composite
def soils(draw: st.DrawFn) -> FloatArray:
    """From fluffy to stiff, on a rim as rough as the soil or smoother; nothing that is pushed, no hump."""
    n = draw(st.floats(0.4, 1.6))
    phi = draw(st.floats(15.0, 45.0))
    return kernel_row(
        soil(
            n=n,
            k_c=0.0,
            k_phi=draw(st.floats(3e3, 1e5)) / 0.01**n,
            cohesion=draw(st.floats(0.0, 3e3)),
            friction_angle_deg=phi,
            interface_friction_angle_deg=draw(st.sampled_from([None, 0.5 * phi, 0.8 * phi])),
            shear_modulus=draw(st.floats(0.003, 0.03)),
            shear_modulus_lateral=draw(st.floats(0.003, 0.03)),
            theta_m_c1=draw(st.floats(0.1, 0.6)),
            theta_m_c2=draw(st.floats(0.0, 0.3)),
            theta_m_c3=0.0,
            exit_angle=draw(st.sampled_from(["zero", "lambda:0.3", "lambda:0.9"])),
            slip_sinkage=draw(st.sampled_from([0.0, 2.0])),
            skid_sinkage=draw(st.sampled_from([0.0, 1.3])),
            side_bulldozing=False,
        )
    )


heights = st.floats(0.0, 0.03)
counts = st.sampled_from([3.0, 8.0, 18.0, 30.0, 60.0, 300.0])
slips, side_slips = st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)


def forces(row: FloatArray, z: float, slip: float, lateral: float, height: float, count: float) -> tuple[float, ...]:
    rim = RigidRim(RADIUS, RADIUS + height, WIDTH, count, 0.0)
    return wheel_forces(rim, EARTH, RimContact(z, slip, lateral, 1.0), row, QUADRATURE)


def pull_at_load(row: FloatArray, load: float, slip: float, height: float, count: float) -> float:
    def missing(z: float) -> float:
        return forces(row, z, slip, 0.0, height, count)[2] - load

    return forces(row, brentq(missing, 1e-6, 0.2, xtol=1e-12), slip, 0.0, height, count)[0]


def test_no_wheel_pulls_more_than_sand_bears() -> None:
    """20 mm grousers on firm sand of 30 degrees without cohesion: at most W tan 30 deg = 0.577 W (it was 0.64 W)."""
    firm = {"k_phi": 1e9, "shear_modulus": 1e-5}
    sand = kernel_row(soil("lunar_nominal", cohesion=0.0, friction_angle_deg=30.0, **firm))
    greatest = max(pull_at_load(sand, 60.0, s, 0.02, n) for s in (0.1, 0.3, 0.6) for n in (12.0, 300.0))
    assert 0.5 < greatest / 60.0 < math.tan(math.radians(30.0))


@settings(max_examples=400, deadline=None)
@given(soils(), st.floats(1e-4, 0.08), slips, side_slips, heights, counts)
def test_pull_is_within_the_strength_of_the_soil(
    row: FloatArray, z: float, slip: float, lateral: float, height: float, count: float
) -> None:
    """Driving: W tan φ + c A/cos φ, A with the sides of the soil between the tips; c alone leans by φ at the most."""
    found = forces(row, z, slip, lateral, height, count)
    entry, exit_angle, _ = contact_angles(RADIUS, z, slip, 1.0, row, travel(slip, lateral)[3])
    area = (WIDTH + 2.0 * height) * (RADIUS + height) * (entry - exit_angle)
    tan_phi = row[SoilColumn.TAN_PHI]
    cohesive = row[SoilColumn.COHESION] * area * math.hypot(1.0, tan_phi)
    assert found[0] <= found[2] * tan_phi + cohesive + 1e-9


@settings(max_examples=300, deadline=None)
@given(soils(), st.floats(1e-4, 0.08), slips, side_slips, heights, counts)
def test_grousers_never_give_energy(
    row: FloatArray, z: float, slip: float, lateral: float, height: float, count: float
) -> None:
    found = forces(row, z, slip, lateral, height, count)
    rim_speed, ahead, _, _ = travel(slip, lateral)
    parts = np.array([found[3] * rim_speed / RADIUS, -found[0] * ahead, found[1] * lateral])
    assert parts.sum() >= -1e-9 * np.abs(parts).sum()


@settings(max_examples=200, deadline=None)
@given(soils(), st.floats(1e-3, 0.06), slips, side_slips, counts)
def test_grousers_without_height_are_none(row: FloatArray, z: float, slip: float, lateral: float, count: float) -> None:
    """As the height goes to nothing every force goes to that of the smooth wheel, in proportion to it."""
    smooth = np.array(forces(row, z, slip, lateral, 0.0, 0.0)[:6])
    for height in (1e-7, 1e-9, 1e-11):
        lugged = np.array(forces(row, z, slip, lateral, height, count)[:6])
        assert np.abs(lugged - smooth).max() <= 1e6 * height * np.abs(smooth).max() + 1e-12


def test_strength_by_hand() -> None:
    """6 mm, 18 on 58 mm, phi 29 deg: N_phi 2.882, pitch 20.2 mm: the faces alone would give tan 1.07, soil 0.554."""
    r, b = 0.058, 0.05
    row = kernel_row(soil(cohesion=900.0, interface_adhesion=100.0))
    cohesion, tan_phi = shear_strength(RigidRim(r, r + 0.006, b, 18.0, 0.001), 0.0, row)
    tan_delta, soil_tan = math.tan(math.radians(23.2)), math.tan(math.radians(29.0))
    tips = 18 * 0.001 / (2.0 * math.pi * 0.064)
    assert tan_phi == pytest.approx(tips * tan_delta + (1.0 - tips) * soil_tan)
    assert 100.0 + 2.0 * 900.0 * math.sqrt(2.8824) * 0.006 * 18 / (2.0 * math.pi * r) > 900.0
    assert cohesion == pytest.approx(tips * 100.0 + (1.0 - tips) * 900.0 * (1.0 + 2.0 * 0.006 / 0.05))
    # few and low: metal where there is no wedge, and the thrust of the faces
    sand = kernel_row(soil())
    per_pitch = 0.001 * 6 / (2.0 * math.pi * r)
    expected = (1.0 - math.sqrt(2.8821) * per_pitch) * tan_delta + 2.8821 * per_pitch
    assert shear_strength(RigidRim(r, r + 0.001, b, 6.0, 0.0), 0.0, sand)[1] == pytest.approx(expected, rel=1e-4)
    assert shear_strength(RigidRim(r, r, b, 0.0, 0.0), 0.0, sand) == (0.0, pytest.approx(tan_delta))
    # a locked wheel pushes the same wedge of soil with grousers as without
    assert shear_strength(RigidRim(r, r + 0.006, b, 18.0, 0.001), 1.0, sand) == (0.0, pytest.approx(tan_delta))


@settings(max_examples=100, deadline=None)
@given(soils(), heights, counts, st.floats(0.0, 1.0))
def test_strength_lies_between_rim_and_soil(row: FloatArray, height: float, count: float, skid: float) -> None:
    cohesion, tan_phi = shear_strength(RigidRim(RADIUS, RADIUS + height, WIDTH, count, 0.001), skid, row)
    sides = 1.0 + 2.0 * height / WIDTH
    assert row[SoilColumn.INTERFACE_ADHESION] <= cohesion <= row[SoilColumn.COHESION] * sides * (1.0 + 1e-12)
    assert row[SoilColumn.INTERFACE_TAN_PHI] <= tan_phi <= row[SoilColumn.TAN_PHI] * (1.0 + 1e-12)


def test_dug_depth_by_hand() -> None:
    """10 mm, 30 on 157 mm, phi 31.9 deg: l 18.0 mm, pitch 33.0 mm, a layer of 2.73 mm; at s 0.6 x 1.5 = 4.1 mm, of
    which the walls of a pit of 0.07 x 0.622 = 43.6 mm take 0.36."""
    tan_phi = math.tan(math.radians(31.9))
    root = math.tan(math.radians(45.0 + 0.5 * 31.9))
    layer = 0.5 * 0.010 * 0.010 * root / (2.0 * math.pi * 0.15735 / 30)
    assert layer == pytest.approx(2.73e-3, rel=2e-3)
    at = {s: dug_depth(RigidRim(0.15735, 0.16735, WIDTH, 30.0, 0.0), s, 0.07, tan_phi) for s in (0.0, 0.01, 0.6, 1.0)}
    assert at[0.0] == 0.0 and at[0.01] == pytest.approx(layer * 0.01 / 0.99, rel=2e-3)
    assert 1.0 / at[0.6] == pytest.approx(0.4 / (0.6 * layer) + 1.0 / (0.07 * tan_phi), rel=1e-3)
    assert 1.0 / at[1.0] == pytest.approx(0.01 / layer + 1.0 / (0.07 * tan_phi))
    assert (
        dug_depth(RigidRim(0.1, 0.11, WIDTH, 20.0, 0.0), 0.5, 0.05, 0.0) == 0.0
    )  # soil without friction closes every pit


@settings(max_examples=100, deadline=None)
@given(heights, counts, st.floats(0.0, 0.99), st.floats(0.1, 1.0))
def test_few_grousers_dig_little_and_close_ones_too(height: float, count: float, slip: float, tan_phi: float) -> None:
    dug = dug_depth(RigidRim(RADIUS, RADIUS + height, WIDTH, count, 0.0), slip, 0.06, tan_phi)
    more = dug_depth(RigidRim(RADIUS, RADIUS + height, WIDTH, count, 0.0), slip + 0.01, 0.06, tan_phi)
    assert 0.0 <= dug <= 0.06 * tan_phi and dug <= more
    assert dug <= 0.5 * height * slip / (1.0 - slip) + 1e-15
    close = dug_depth(RigidRim(RADIUS, RADIUS + height, WIDTH, 1e9, 0.0), slip, 0.06, tan_phi)
    few = dug_depth(RigidRim(RADIUS, RADIUS + height, WIDTH, 1e-6, 0.0), slip, 0.06, tan_phi)
    assert close <= 1e-6 and few <= 1e-6


@pytest.mark.parametrize("name", ["cmu_sand", "lunar_nominal", "ding_2011"])
def test_grousers_dig(name: str) -> None:
    """Deeper with the slip than a smooth wheel, ever more, and not without end where the wheel spins on the spot."""
    smooth = WheelShape(name="smooth", citation="test", radius=0.1, width=0.08)
    lugged = smooth.model_copy(update={"grouser_height": 0.01, "grouser_count": 18})
    at = [0.0, 0.3, 0.6, 0.9, 1.0]
    low, high = (np.array([one.sinkage_m for one in measure(w, soil(name), 40.0, at)]) for w in (smooth, lugged))
    more = high - low
    assert np.all(np.diff(more) > 0.0) and abs(more[0]) < 1e-3 and more[-1] < 0.06
