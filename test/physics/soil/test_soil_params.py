"""Soil files against the published table, and what a soil refuses."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numba import njit
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.soil import regolith
from sojourn_physics.soil.bearing import bearing_factors
from sojourn_physics.soil.params import (
    SOIL_COLUMNS,
    SoilColumn,
    SoilParams,
    kernel_row,
    kernel_table,
    parse_exit_angle,
)

SOILS = Path(__file__).parents[3] / "config" / "soils"

# name: n, k_c [N/m^(n+1)], k_phi [N/m^(n+2)], cohesion [Pa], friction angle [degree]; None where the file's number has
# been identified from trials instead
PUBLISHED: dict[str, tuple[float | None, ...]] = {
    "lunar_nominal": (1, 1400, 820e3, 170, 35),
    "ishigami_2007": (1, 1370, 814e3, 800, 37.2),
    "fjs_1": (1, 1370, 820e3, 200, 38),
    "jsc_1a": (1, 1400, 820e3, 1000, 45),
    "grc_1": (0.8, 700, 505e3, 250, 38),
    "ding_2011": (1.10, 15.6e3, 2407.4e3, 250, 31.9),
    "kls_1": (1.2594, -44.06e3, None, 1716, 40.6),
    "cmu_sand": (1.46, 0, None, None, 29),
    "dry_sand": (1.1, 990, 1528.43e3, 1040, 28),
    "sandy_loam": (0.7, 5270, 1515.04e3, 1720, 29),
    "lete_sand": (0.79, 102e3, 5301e3, 1300, 31.1),
    "clayey_soil": (0.5, 13.19e3, 692.15e3, 4140, 13),
    "lean_clay": (0.2, 16.43e3, 1724.69e3, 68950, 20),
    "snow": (1.6, 4370, 196.72e3, 1030, 19.7),
    "dlr_mars": (0.8, 5790, 180e3, 300, 17.8),
}


def read(name: str) -> dict[str, Any]:
    values: dict[str, Any] = yaml.safe_load((SOILS / f"{name}.yaml").read_text(encoding="utf-8"))
    return values


def load(name: str) -> SoilParams:
    return SoilParams(**read(name))


def every_soil() -> list[SoilParams]:
    return [load(path.stem) for path in sorted(SOILS.glob("*.yaml"))]


def test_every_file_loads_and_has_the_name_of_its_file() -> None:
    names = sorted(path.stem for path in SOILS.glob("*.yaml"))
    assert set(names) >= set(PUBLISHED) | {"mars", "rigid_rock"}
    assert [soil.name for soil in every_soil()] == names


@pytest.mark.parametrize(("name", "row"), PUBLISHED.items())
def test_soil_is_the_published_one(name: str, row: tuple[float | None, ...]) -> None:
    soil = load(name)
    assert soil.form == "bekker"
    found = (soil.n, soil.k_c, soil.k_phi, soil.cohesion, soil.friction_angle_deg)
    assert all(published in (None, value) for value, published in zip(found, row, strict=True))
    assert not {"n", "k_c", "k_phi", "friction_angle_deg"} & set(soil.estimates)


@pytest.mark.published("Ishigami 2007, Lunar Sourcebook")
def test_published_shear_moduli_and_densities() -> None:
    lunar, ishigami, kls = load("lunar_nominal"), load("ishigami_2007"), load("kls_1")
    assert lunar.shear_modulus == 0.0178
    assert lunar.unit_weight(1.624) == pytest.approx(2470.0, rel=1e-4)
    assert (kls.shear_modulus, kls.density) == (0.018, 1600.0)
    assert 0.0097 <= load("ding_2011").shear_modulus <= 0.0131
    assert load("cmu_sand").density == 1330.0
    assert (ishigami.theta_m_c1, ishigami.theta_m_c2, ishigami.exit_lambda) == (0.40, 0.15, 0.9)
    assert (ishigami.shear_modulus, ishigami.shear_modulus_per_slip_angle) == (0.036, 0.043)
    assert (ishigami.shear_modulus_lateral, ishigami.shear_modulus_lateral_per_slip_angle) == (0.013, 0.020)
    assert ishigami.density == 1600.0
    # Destructive angle of Ishigami's table from the friction angle.
    assert 45.0 - 0.5 * ishigami.friction_angle_deg == pytest.approx(26.4, abs=0.01)


def test_viking_numbers_of_the_mars_soil() -> None:
    mars = load("mars")
    assert (mars.friction_angle_deg, mars.cohesion, mars.density) == (34.5, 1100.0, 1400.0)
    assert {"n", "k_c", "k_phi"} <= set(mars.estimates)


@pytest.mark.parametrize(
    ("name", "numbers"),
    [
        ("viking_drift", (18.0, 1600.0, 1150.0)),
        ("viking_blocky", (30.8, 5500.0, 1600.0)),
        ("lunar_regolith", (42.0, 520.0, pytest.approx(regolith.mean_density(0.15), abs=0.1))),
    ],
)
def test_strength_and_density_of_planetary_soils(name: str, numbers: tuple[float, float, float]) -> None:
    soil = load(name)
    assert (soil.friction_angle_deg, soil.cohesion, soil.density) == numbers


def symmetric_force(k_phi: float, radius: float, width: float, sinkage: float) -> float:
    """Vertical force on a wheel with p = k z on both sides of the lowest point, by the midpoint rule."""
    entry = math.acos(1.0 - sinkage / radius)
    angles = (np.arange(4000) + 0.5) / 4000 * entry
    pressure = k_phi * radius * (np.cos(angles) - math.cos(entry))
    return float(2.0 * radius * width * np.sum(pressure * np.cos(angles)) * entry / 4000)


def test_rock_is_stiff_enough_and_not_too_stiff_for_explicit_steps() -> None:
    rock = load("rigid_rock")
    assert rock.kind == "rigid" and rock.n == 1.0 and rock.k_c == 0.0 and rock.cohesion == 0.0
    assert rock.exit_lambda == 1.0 and rock.theta_m_c1 == rock.theta_m_c2 == 0.0
    low, high = 0.0, 2e-3
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if symmetric_force(rock.k_phi, 0.125, 0.16, middle) < 50.0 else (low, middle)
    assert low == pytest.approx(0.45e-3, rel=0.05)  # as the file says
    step = 1e-7
    above = symmetric_force(rock.k_phi, 0.125, 0.16, low + step)
    below = symmetric_force(rock.k_phi, 0.125, 0.16, low - step)
    assert 1e5 <= (above - below) / (2.0 * step) <= 1e6


@pytest.mark.parametrize("soil", every_soil(), ids=lambda soil: soil.name)
def test_wheel_of_the_rover_dropped_on_the_soil_comes_to_rest(soil: SoilParams) -> None:
    """2.5 kg and 47 N more, at 1 m/s, explicit steps of 1 ms: rebound slower than the impact, then rest."""
    mass, load_force, radius, width, step = 2.5, 47.0, 0.125, 0.16, 1e-3
    modulus = soil.k_c / width + soil.k_phi
    sides = 2.0 if soil.kind == "rigid" else 1.0
    sinkage, speed, fastest_rebound = 0.0, 1.0, 0.0
    for _ in range(2000):
        force = 0.0
        if sinkage > 0.0:
            entry = math.acos(max(-1.0, 1.0 - sinkage / radius))
            angles = (np.arange(40) + 0.5) / 40 * entry
            depth = radius * (np.cos(angles) - math.cos(entry))
            mean_pressure = modulus * float(np.mean(depth**soil.n * np.cos(angles)))
            force = sides * radius * width * entry * mean_pressure
            force *= max(0.0, 1.0 + soil.contact_damping * speed)
        speed += step * (1.624 + (load_force - force) / mass)
        sinkage += step * speed
        fastest_rebound = min(fastest_rebound, speed)
    assert -fastest_rebound < 0.7
    assert abs(speed) < 1e-4
    assert 0.0 < sinkage < radius


def test_exit_angle_is_read() -> None:
    assert parse_exit_angle("zero") is None
    assert parse_exit_angle("lambda:0.9") == 0.9
    assert parse_exit_angle("lambda:0") == 0.0


@pytest.mark.parametrize(
    "text", ["", "Zero", "lambda", "lambda:", "lambda:x", "lambda:-0.1", "lambda:2.1", "lambda:nan", "0.9"]
)
def test_unreadable_exit_angle_is_refused(text: str) -> None:
    with pytest.raises(InvalidValueError, match="lambda:L"):
        parse_exit_angle(text)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"n": 0.0}, "n"),
        ({"n": float("nan")}, "n"),
        ({"k_phi": float("inf")}, "k_phi"),
        ({"k_phi": 0.0, "k_c": -5.0}, "k_phi"),
        ({"cohesion": -1.0}, "cohesion"),
        ({"friction_angle_deg": 80.0}, "friction_angle_deg"),
        ({"shear_modulus": 0.0}, "shear_modulus"),
        ({"density": 0.0}, "density"),
        ({"theta_m_c1": 0.8, "theta_m_c2": 0.3}, "theta_m"),
        ({"exit_angle": "lamda:0.9"}, "exit_angle"),
        ({"form": "wong"}, "form"),
        ({"estimates": ["colour"]}, "colour"),
        ({"shear_moduls": 0.1}, "shear_moduls"),
    ],
)
def test_bad_input_is_refused_by_name(changes: dict[str, Any], word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        SoilParams(**{**read("lunar_nominal"), **changes})


@pytest.mark.parametrize("gravity", [-1.0, float("nan"), float("inf")])
def test_unit_weight_refuses_bad_gravity(gravity: float) -> None:
    with pytest.raises(InvalidValueError, match="gravity"):
        load("jsc_1a").unit_weight(gravity)


def test_kernel_row_holds_every_number_in_its_column() -> None:
    soil = load("ishigami_2007")
    row = kernel_row(soil)
    assert row.dtype == np.float64 and row.flags.c_contiguous and row.shape == (len(SOIL_COLUMNS),)
    named = dict(zip(SOIL_COLUMNS, row.tolist(), strict=True))
    assert named == {
        "form": 0.0, "n": 1.0, "k_c": 1370.0, "k_phi": 814e3, "cohesion": 800.0,
        "tan_phi": pytest.approx(0.75904, abs=1e-5),
        "shear_modulus": 0.036, "shear_modulus_lateral": 0.013, "theta_m_c1": 0.40,
        "theta_m_c2": 0.15, "exit_lambda": 0.9, "contact_damping": 5.0, "density": 1600.0,
        "shear_modulus_per_slip_angle": 0.043, "shear_modulus_lateral_per_slip_angle": 0.020,
        "unloading_stiffness": 0.0, "unloading_stiffness_per_sinkage": 503.0e6,
        "interface_adhesion": 800.0, "interface_tan_phi": named["tan_phi"], "residual": 1.0, "hump": 0.0,
        "friction_angle_deg": soil.friction_angle_deg,
        "slip_sinkage": 0.0, "skid_sinkage": 0.0, "side_sinkage": 0.0, "theta_m_c3": 0.0, "front_bulldozing": 0.0,
        "side_bulldozing": 0.0, "bulldozing_cohesion": 800.0, "bulldozing_tan_phi": pytest.approx(named["tan_phi"]),
        "bulldozing_k_c": pytest.approx(bearing_factors(soil.friction_angle).k_c),
        "bulldozing_k_gamma": pytest.approx(bearing_factors(soil.friction_angle).k_gamma),
        "bulldozing_modulus": 0.02, "compacted_share": 0.5,
    }  # fmt: skip
    rock = kernel_row(load("rigid_rock"))  # springs back along its own line, and keeps no rut
    assert rock[SoilColumn.UNLOADING_STIFFNESS] == rock[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE] == 0.0
    reece = SoilParams(**{**read("jsc_1a"), "form": "reece"})
    assert kernel_row(reece)[SoilColumn.FORM] == 1.0
    assert kernel_row(reece)[SoilColumn.EXIT_LAMBDA] == -1.0


def test_kernel_table_is_in_order_and_readable_by_a_kernel() -> None:
    @njit
    def modulus(table: FloatArray, soil: int) -> float:
        return table[soil, SoilColumn.K_PHI]

    table = kernel_table(every_soil())
    assert table.flags.c_contiguous and bool(np.isfinite(table).all())
    for index, soil in enumerate(every_soil()):
        assert modulus(table, index) == soil.k_phi
    with pytest.raises(InvalidValueError, match="soils"):
        kernel_table([])
