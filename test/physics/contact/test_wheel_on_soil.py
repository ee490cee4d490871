"""The wheel's stress integrals against adaptive quadrature written anew here, and their limits."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_config.load import load_params
from sojourn_config.paths import config_folder
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_rim import Quadrature, RimContact
from sojourn_physics.contact.wheel_on_soil import (
    MAX_ENTRY_ANGLE,
    QUADRATURE,
    contact_angles,
    pressure_modulus,
    rim_forces,
    travel,
)
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_row

RADIUS, SHEAR_RADIUS, WIDTH = 0.125, 0.131, 0.16
SAND = {"n": 1.0, "k_c": 1400.0, "k_phi": 820e3, "cohesion": 170.0, "friction_angle_deg": 35.0}

REFINED: dict[str, object] = {
    "interface_friction_angle_deg": 18.0,
    "interface_adhesion": 50.0,
    "residual_shear_ratio": 0.7,
    "slip_sinkage": 0.6,
    "skid_sinkage": 1.5,
    "side_sinkage": 1.2,
    "theta_m_c3": 0.3,
}
"""All terms beyond Wong and Reece's, but for the soil that a wheel pushes."""
EARTH = 9.81
SOILS = sorted({path.stem for path in (config_folder() / "soils").glob("*.yaml")} - {"rigid_rock"})
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(200)
FINE = Quadrature(0.5 * (_POINTS + 1.0), 0.5 * _WEIGHTS)
"""Converged, for what the few points of the loop leave out."""


def make_soil(**changes: object) -> FloatArray:
    values: dict[str, object] = {
        "name": "sand",
        "citation": "test",
        **SAND,
        "shear_modulus": 0.0178,
        "shear_modulus_lateral": 0.0178,
        "density": 1500.0,
        "theta_m_c1": 0.4,
        "theta_m_c2": 0.2,
        "contact_damping": 0.0,
    }
    return kernel_row(SoilParams.model_validate({**values, **changes}))


SOFT_AND_STEEP = make_soil(
    n=1.8, k_c=0.0, k_phi=1e4 / 0.01**1.8, cohesion=0.0, friction_angle_deg=45.0, shear_modulus=0.008,
    shear_modulus_lateral=0.008, theta_m_c1=0.5, theta_m_c2=0.4, exit_angle="lambda:0.3", **REFINED
)  # fmt: skip
"""Whose stress is greatest at 0.95 of the entry angle where the wheel spins on."""


@st.composite
def soils(draw: st.DrawFn) -> FloatArray:
    """Soils from fluffy snow to stiff clay, in both forms of the pressure law."""
    n = draw(st.floats(0.2, 1.8))
    form = draw(st.sampled_from(["bekker", "reece"]))
    stiffness = draw(st.floats(1e3, 3e4)) / 0.01**n  # pressure of 1 to 30 kPa at 1 cm
    return make_soil(
        n=n,
        form=form,
        k_c=0.0,
        k_phi=stiffness if form == "bekker" else stiffness * WIDTH ** (n - 1.0),
        cohesion=draw(st.floats(0.0, 3e3)),
        friction_angle_deg=draw(st.floats(5.0, 45.0)),
        shear_modulus=draw(st.floats(0.008, 0.05)),
        shear_modulus_lateral=draw(st.floats(0.008, 0.05)),
        shear_modulus_per_slip_angle=draw(st.sampled_from([0.0, 0.04])),
        shear_modulus_lateral_per_slip_angle=draw(st.sampled_from([0.0, 0.02])),
        theta_m_c1=draw(st.floats(0.1, 0.5)),
        theta_m_c2=draw(st.floats(0.0, 0.4)),
        exit_angle=draw(st.sampled_from(["zero", "lambda:0.3", "lambda:0.9", "lambda:1.2"])),
        **draw(st.sampled_from([{}, REFINED])),
    )


slips = st.floats(-1.0, 1.0)
side_slips = st.floats(-0.6, 0.6)
sinkages = st.floats(0.001, 0.06)
rollings = st.sampled_from([0.0, 0.3, 1.0])


def rim(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float = 0.0, rolling: float = 1.0
) -> tuple[float, ...]:
    contact = RimContact(sinkage, slip, side_slip, rolling)
    return rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, QUADRATURE)


def integrated(soil: FloatArray, sinkage: float, slip: float, side_slip: float, rolling: float) -> tuple[float, ...]:
    """F_x, F_y, F_z, T, M_x, M_z by adaptive quadrature of the stresses of the module's equations."""
    column = SoilColumn
    n = soil[column.N]
    if soil[column.FORM] == 0.0:
        modulus = soil[column.K_C] / WIDTH + soil[column.K_PHI]
    else:
        modulus = (soil[column.K_C] + WIDTH * soil[column.K_PHI]) / WIDTH**n
    theta_1 = math.acos(1.0 - sinkage / RADIUS)
    ratio = soil[column.EXIT_LAMBDA]
    behind = 0.0 if ratio < 0.0 else math.acos(1.0 - ratio * sinkage / RADIUS)
    rim_speed, ahead, total_slip, sideways = motion(slip, side_slip)
    theta_2 = -rolling * behind - (1.0 - rolling) * theta_1
    share = soil[column.THETA_M_C1] + soil[column.THETA_M_C2] * slip + soil[column.THETA_M_C3] * sideways
    theta_m = rolling * min(max(share, 0.0), 0.95) * theta_1
    driven = soil[column.SLIP_SINKAGE] * total_slip
    if total_slip < 0.0:
        driven = soil[column.SKID_SINKAGE] * total_slip**2
    deeper = 1.0 + rolling * ((1.0 - sideways) * driven + sideways * soil[column.SIDE_SINKAGE])
    cohesion, tan_phi = lugged_strength(soil, rolling * max(-slip, 0.0))
    slip_angle = math.atan2(abs(side_slip), max(1.0 - rolling * max(slip, 0.0), 1e-3))
    k_x = soil[column.SHEAR_MODULUS]
    k_x += soil[column.SHEAR_MODULUS_PER_SLIP_ANGLE] * slip_angle
    k_y = soil[column.SHEAR_MODULUS_LATERAL]
    k_y += soil[column.SHEAR_MODULUS_LATERAL_PER_SLIP_ANGLE] * slip_angle
    length = 2.0 * RADIUS * math.sin(theta_1)

    def stresses(theta: float) -> tuple[float, float, float]:
        front = theta
        if theta < theta_m:
            front = theta_1 - (theta - theta_2) * (theta_1 - theta_m) / (theta_m - theta_2)
        sigma = modulus * (max(RADIUS * (math.cos(front) - math.cos(theta_1)), 0.0) / deeper) ** n
        if slip >= 0.0:  # Wong and Reece: r [θ1 - θ - (1 - s)(sin θ1 - sin θ)]
            rolled = theta_1 - theta - (1.0 - slip) * (math.sin(theta_1) - math.sin(theta))
        else:
            rolled = (1.0 + slip) * (theta_1 - theta) - (math.sin(theta_1) - math.sin(theta))
        x = (rolling * SHEAR_RADIUS * rolled + (1.0 - rolling) * slip * length) / k_x
        y = side_slip * (rolling * SHEAR_RADIUS * (theta_1 - theta) + (1.0 - rolling) * length) / k_y
        j = math.hypot(x, y)
        if j == 0.0:
            return sigma, 0.0, 0.0
        rest = math.exp(-j)
        # the force of the rim, σ r dθ, passes whole to the circle of the tips
        tau = (
            (cohesion + sigma * RADIUS / SHEAR_RADIUS * tan_phi)
            * (1.0 - rest)
            * (soil[column.RESIDUAL] + soil[column.HUMP] * rest)
        )
        return sigma, tau * x / j, tau * y / j

    r, b, q = RADIUS, WIDTH, SHEAR_RADIUS

    def total(term: object) -> float:
        assert callable(term)
        options = {"epsabs": 1e-9, "epsrel": 1e-10, "limit": 200}
        parts = [quad(lambda t: term(t, *stresses(t)), low, high, **options)[0] for low, high in spans]
        return float(sum(parts))

    spans = [(theta_2, theta_m), (theta_m, theta_1)]
    pressed_back = min(total(lambda t, s, x, y: -b * r * s * math.sin(t)), 0.0)
    pressed_up = total(lambda t, s, x, y: b * r * s * math.cos(t))
    sheared = np.array(
        [
            total(lambda t, s, x, y: b * q * x * math.cos(t)),
            total(lambda t, s, x, y: b * q * y),
            total(lambda t, s, x, y: b * q * x * math.sin(t)),
            total(lambda t, s, x, y: b * q * q * x),
            total(lambda t, s, x, y: b * q * q * y * math.cos(t)),
            total(lambda t, s, x, y: b * q * q * y * math.sin(t)),
        ]
    )
    # shear never gives more than the pressure takes
    given_back = -(sheared[3] * rim_speed / r - sheared[0] * ahead + sheared[1] * side_slip)
    if rolling == 1.0 and given_back > -pressed_back * ahead:
        sheared *= -pressed_back * ahead / given_back
    sheared[0] += pressed_back
    sheared[2] = max(sheared[2] + pressed_up, 0.0)
    return tuple(float(value) for value in sheared)


def motion(slip: float, side_slip: float) -> tuple[float, float, float, float]:
    """rω, v_x, s', e over V = max(rω, |v|), from the definitions of the slips: one of the two speeds is 1."""
    rim_speed, ahead = 1.0, 1.0 - slip
    if math.hypot(ahead, side_slip) > 1.0:
        ahead = math.sqrt(1.0 - side_slip**2)
        rim_speed = min(max(ahead + slip, 0.0), 1.0)
    speed = min(math.hypot(ahead, side_slip), 1.0)
    return rim_speed, ahead, rim_speed - speed, (speed - ahead) / math.hypot(speed, 0.01)


def lugged_strength(soil: FloatArray, skid: float) -> tuple[float, float]:
    """c, and tan φ over the normal force, between grousers that stand close together: that of the soil, with the sides
    of the block, as far as the wheel is not locked; of the bare rim where it is."""
    cohesion = soil[SoilColumn.COHESION] * (1.0 + 2.0 * (SHEAR_RADIUS - RADIUS) / WIDTH)
    bare = soil[SoilColumn.INTERFACE_ADHESION], soil[SoilColumn.INTERFACE_TAN_PHI]
    return (
        skid * bare[0] + (1.0 - skid) * cohesion,
        skid * bare[1] + (1.0 - skid) * soil[SoilColumn.TAN_PHI],
    )


@settings(max_examples=60, deadline=None)
@given(soils(), sinkages, slips, side_slips, rollings)
def test_forces_are_the_integrals_of_the_stresses(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float, rolling: float
) -> None:
    expected = integrated(soil, sinkage, slip, side_slip, rolling)
    contact = RimContact(sinkage, slip, side_slip, rolling)
    found = rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, FINE)
    scale = math.hypot(*expected[:3]) + 1e-3
    assert np.allclose(found[:3], expected[:3], rtol=0.0, atol=1e-5 * scale)
    assert np.allclose(found[3:6], expected[3:6], rtol=0.0, atol=1e-5 * scale * RADIUS)


@settings(max_examples=200, deadline=None)
@given(soils(), sinkages, slips, side_slips, rollings)
@example(SOFT_AND_STEEP, 0.03125, 1.0, 0.5, 1.0)
def test_quadrature_error_of_the_few_points(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float, rolling: float
) -> None:
    """Near the entry, θm leaves nearly the whole contact, with the shear's steep rise, to one side of it."""
    contact = RimContact(sinkage, slip, side_slip, rolling)
    fine = rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, FINE)
    coarse = rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, QUADRATURE)
    scale = math.hypot(*fine[:3]) + 1e-3
    sideways = travel(slip, side_slip).sideways
    entry, _, greatest = contact_angles(RADIUS, sinkage, slip, rolling, soil, sideways)
    error = 5e-3 if greatest < 0.7 * entry else 3e-2
    assert np.allclose(coarse[:3], fine[:3], rtol=0.0, atol=error * scale)
    assert np.allclose(coarse[3:6], fine[3:6], rtol=0.0, atol=error * scale * RADIUS)


@pytest.mark.parametrize("name", SOILS)
def test_quadrature_error_on_the_soils_of_the_library(name: str) -> None:
    soil = kernel_row(load_params("soils", name, SoilParams))
    for slip, side_slip in ((-0.5, 0.1), (0.0, 0.0), (0.2, 0.1), (0.8, 0.3), (1.0, 0.5)):
        contact = RimContact(0.03, slip, side_slip, 1.0)
        fine = rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, FINE)
        coarse = rim_forces(RADIUS, SHEAR_RADIUS, WIDTH, contact, soil, QUADRATURE)
        assert np.allclose(coarse[:3], fine[:3], rtol=0.0, atol=1e-3 * math.hypot(*fine[:3]))


def test_quadrature_error_on_lunar_soil() -> None:
    for slip in (-0.5, 0.0, 0.2, 0.8):
        arguments = (RADIUS, SHEAR_RADIUS, WIDTH, RimContact(0.015, slip, 0.1, 1.0), make_soil())
        fine = rim_forces(*arguments, FINE)
        coarse = rim_forces(*arguments, QUADRATURE)
        assert np.allclose(coarse[:3], fine[:3], rtol=0.0, atol=2e-5 * math.hypot(*fine[:3]))


@settings(max_examples=150, deadline=None)
@given(soils(), st.floats(-1.0, 10.0), slips, st.floats(-1.0, 1.0), st.floats(0.0, 1.0))
def test_finite_and_never_pulled_down(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float, rolling: float
) -> None:
    forces = rim(soil, sinkage, slip, side_slip, rolling)
    assert all(math.isfinite(value) for value in forces)
    assert forces[2] >= 0.0
    if sinkage <= 0.0:
        assert forces == (0.0,) * 7


@settings(max_examples=100, deadline=None)
@given(soils(), sinkages, st.floats(1.01, 1.5), rollings)
def test_a_driven_wheel_bears_more_the_deeper_it_sinks(
    soil: FloatArray, sinkage: float, factor: float, rolling: float
) -> None:
    for slip in (0.0, 0.1, 0.4):
        deeper, here = (rim(soil, z, slip, 0.0, rolling)[2] for z in (sinkage * factor, sinkage))
        # cohesive soil too soft to bear the shear behind the axle gives the least, none
        assert deeper > here or deeper == here == 0.0


def test_bears_more_and_more_beyond_the_last_entry_angle() -> None:
    last = RADIUS * (1.0 - math.cos(MAX_ENTRY_ANGLE))
    loads = [rim(make_soil(), last * factor, 0.1)[2] for factor in (0.99, 1.0, 1.01, 1.5, 3.0)]
    assert loads == sorted(loads)
    assert loads[2] - loads[1] < 0.05 * loads[1]


@settings(max_examples=100, deadline=None)
@given(soils(), sinkages, st.floats(0.0, 1.0), st.floats(-1e-7, 1e-7), side_slips)
def test_continuous_through_zero_slip(
    soil: FloatArray, sinkage: float, rolling: float, small: float, side_slip: float
) -> None:
    here = np.array(rim(soil, sinkage, 0.0, side_slip, rolling))
    there = np.array(rim(soil, sinkage, small, side_slip, rolling))
    assert np.allclose(here, there, rtol=0.0, atol=2e-5 * (np.abs(here).max() + 1.0))


@settings(max_examples=100, deadline=None)
@given(soils(), sinkages, slips, side_slips)
def test_pressed_straight_down_has_no_sense_of_travel(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float
) -> None:
    """At D = 0 the sense of travel turns over: slip s ahead has to be -s in the mirror, in every force."""
    ahead = np.array(rim(soil, sinkage, slip, side_slip, 0.0))
    mirrored = np.array(rim(soil, sinkage, -slip, side_slip, 0.0)) * [-1, 1, 1, -1, 1, -1, 1]
    assert np.allclose(ahead, mirrored, rtol=0.0, atol=1e-9 * np.abs(ahead).max() + 1e-12)


@settings(max_examples=60, deadline=None)
@given(soils(), sinkages, slips, side_slips, rollings)
def test_shear_never_exceeds_the_strength_of_the_soil(
    soil: FloatArray, sinkage: float, slip: float, side_slip: float, rolling: float
) -> None:
    """Shear along and across the rim, together, stays under that of a rim sheared to its limit everywhere."""
    found = rim(soil, sinkage, slip, side_slip, rolling)
    ceiling = strength(soil, sinkage, slip, rolling)
    assert math.hypot(found[3] / SHEAR_RADIUS, found[1]) <= ceiling / SHEAR_RADIUS * (1.0 + 1e-3)


def strength(soil: FloatArray, sinkage: float, slip: float, rolling: float) -> float:
    """b r_s ∫ (c r_s + σ r tan φ) dθ, by the mean value of many points."""
    theta_1, theta_2, theta_m = contact_angles(RADIUS, sinkage, slip, rolling, soil)
    theta = np.linspace(theta_2, theta_1, 20001)
    front = theta_1 - (theta - theta_2) * (theta_1 - theta_m) / max(theta_m - theta_2, 1e-12)
    mapped = np.where(theta < theta_m, front, theta)
    depth = np.maximum(RADIUS * (np.cos(mapped) - math.cos(theta_1)), 0.0)
    sigma = pressure_modulus(soil, WIDTH) * depth ** soil[SoilColumn.N]
    cohesion, tan_phi = lugged_strength(soil, rolling * max(-slip, 0.0))
    tau = 1.06 * (cohesion + sigma * RADIUS / SHEAR_RADIUS * tan_phi)  # Wong's hump stands up to 6 % above the limit
    return float(WIDTH * SHEAR_RADIUS**2 * np.trapezoid(tau, theta))


def test_locked_wheel_on_snow_is_not_pulled_down() -> None:
    """Cohesion ahead of a locked wheel on soft soil outweighs the pressure, by the integrals alone."""
    snow = make_soil(n=1.6, k_c=4370.0, k_phi=196.72e3, cohesion=1030.0, friction_angle_deg=19.7)
    assert rim(snow, 1e-3, -1.0)[2] == 0.0
    assert rim(snow, 0.05, -1.0)[2] > 0.0


@pytest.mark.parametrize("width", [0.01, 0.0123, 0.02])
def test_negative_cohesive_modulus_never_makes_a_negative_pressure(width: float) -> None:
    soil = make_soil(n=1.2594, k_c=-44.06e3, k_phi=3581.8e3)
    assert pressure_modulus(soil, width) == pytest.approx(max(3581.8e3 - 44.06e3 / width, 0.0))
