"""The rigid wheel on soil against published cases: sinkage, drawbar pull and torque at a given load."""

import csv
import math
from pathlib import Path

import pytest
from scipy.optimize import brentq

from sojourn_physics.contact.rigid_rim import RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, contact_angles, rim_forces
from sojourn_physics.soil.params import SoilParams, kernel_row
from sojourn_physics.soil.pressure_sinkage import compaction_resistance, wheel_sinkage

LINES = (Path(__file__).parent / "rigid_wheel.csv").read_text(encoding="utf-8").splitlines()
CASES = list(csv.DictReader(line for line in LINES if not line.startswith("#")))
TOLERANCE = 0.01


def soil_of(case: dict[str, str]) -> SoilParams:
    given = ("n", "k_c", "k_phi", "cohesion", "friction_angle_deg", "shear_modulus")
    return SoilParams(
        name="case",
        citation="rigid_wheel.csv",
        shear_modulus_lateral=float(case["shear_modulus"]),
        density=1600.0,
        theta_m_c1=float(case["c1"]),
        theta_m_c2=float(case["c2"]),
        exit_angle=case["exit_angle"],
        contact_damping=0.0,
        **{name: float(case[name]) for name in given},
    )


def forces(case: dict[str, str], sinkage: float) -> tuple[float, ...]:
    radius, width = float(case["radius"]), float(case["width"])
    slip, rolling = float(case["slip"]), float(case["rolling"])
    row = kernel_row(soil_of(case))
    return rim_forces(radius, radius, width, RimContact(sinkage, slip, 0.0, rolling), row, QUADRATURE)


@pytest.mark.published("Wong & Reece 1967 with the wheels of rigid_wheel.csv, by two routes")
@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["case"]))
def test_sinkage_pull_and_torque_at_the_load(case: dict[str, str]) -> None:
    load, radius = float(case["load"]), float(case["radius"])
    sinkage = brentq(lambda z: forces(case, z)[2] - load, 1e-6, 0.6 * radius, xtol=1e-10)
    pull, _, _, torque, *_ = forces(case, sinkage)
    assert sinkage == pytest.approx(float(case["sinkage"]), rel=TOLERANCE)
    # a pull near zero is a difference of two forces: one hundredth of the least of the other rows
    assert pull == pytest.approx(float(case["drawbar_pull"]), rel=TOLERANCE, abs=0.01)
    if case["torque"]:
        assert torque == pytest.approx(float(case["torque"]), rel=TOLERANCE, abs=1e-9)


@pytest.mark.published("Ishigami et al. 2007, J. Field Robotics 24(3):233")
def test_static_contact_angle_of_ishigami() -> None:
    case = next(case for case in CASES if case["case"] == "ishigami-static")
    entry, exit_angle, greatest = contact_angles(0.09, 0.01181, 0.0, 0.0, kernel_row(soil_of(case)))
    assert math.degrees(entry) == pytest.approx(29.68, rel=TOLERANCE)
    assert exit_angle == -entry
    assert greatest == 0.0


@pytest.mark.published
def test_towed_wheel_of_the_lunar_roving_vehicle() -> None:
    """Bekker's closed forms: 253 N on a wheel of 0.813 x 0.229 m, n 1, k_c 1400, k_phi 820e3."""
    soil = soil_of(CASES[0])
    sinkage = wheel_sinkage(soil, 253.0, 0.813, 0.229)
    assert sinkage == pytest.approx(0.01704, rel=1e-3)
    assert compaction_resistance(soil, 0.229, sinkage) == pytest.approx(27.47, rel=1e-3)


@pytest.mark.parametrize(("slip", "thrust"), [(0.05, 25.16), (0.2, 75.39), (0.5, 119.8)])
def test_janosi_thrust_of_the_same_wheel(slip: float, thrust: float) -> None:
    """Thrust of a flat contact of length l, (Ac + W tan phi)(1 - K/(s l)(1 - exp(-s l/K))), and its limit.

    l = A/b is the contact length of the figures, K 0.0178 m, c 170 Pa, phi 33 deg (Janosi & Hanamoto 1961).
    """
    area = 0.229 * 0.4065 * math.acos(1.0 - 2.0 * 0.01704 / 0.813)
    assert area == pytest.approx(0.02705, rel=1e-3)
    largest = area * 170.0 + 253.0 * math.tan(math.radians(33.0))
    assert largest == pytest.approx(168.9, rel=1e-3)
    ratio = slip * area / 0.229 / 0.0178
    assert largest * (1.0 - (1.0 - math.exp(-ratio)) / ratio) == pytest.approx(thrust, rel=1e-3)
