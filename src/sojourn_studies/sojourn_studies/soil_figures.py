"""Footings on a soil, and what digging takes, in figures: the work of scripts/soil_test."""

import argparse
import json
import math
from collections.abc import Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from sojourn_analysis.soil.footing import pad_sinkage, safe_load, ultimate_pressure
from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.supports import ScoopParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.soil.digging import Bucket, DiggingSoil, balovnev, mckyes
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.pressure_sinkage import modulus, pressure
from sojourn_physics.soil.regolith import mean_density, soil_at
from sojourn_physics.soil.relative_density import relative_density_at
from sojourn_physics.soil.repeated_loading import rut_depth
from sojourn_physics.soil.shear import shear_limit, shear_stress
from sojourn_studies.wheel_bed import print_table

LUNAR = "lunar_"
"""Soils whose name begins so have a depth: see `regolith`."""
BUCKET_WALL = 0.001
"""Thickness of a bucket's side walls and edge [m]."""
TOOL_FRICTION = math.radians(ScoopParams.model_fields["tool_friction_deg"].default)
"""Of soil on the blade, as of a scoop whose file says nothing [rad]."""
SHEARED = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Displacements for which the shear stress is told [mm]."""


def _run(given: argparse.Namespace) -> int:
    soil = load_params("soils", given.soil, SoilParams, given.set)
    if soil.kind == "rigid":
        raise UsageError(f"soil {soil.name}: it is rock; allowed is a soil that yields")
    if not (math.isfinite(given.load) and given.load > 0.0):
        raise UsageError(f"--load {given.load:g}: allowed is more than 0 N")
    gravity = load_params("bodies", given.body, BodyParams).surface_gravity
    found: dict[str, Any] = {
        "soil": soil.name,
        "gravity": gravity,
        "density": soil.density,
        "relative_density": _relative_density(soil),
        "pads": [pad(soil, gravity, diameter, given.load, given.safety) for diameter in given.diameter],
        "shear": shear(soil, given.load / (0.25 * math.pi * given.diameter[0] ** 2)),
    }
    found["digging"] = [digging(soil, gravity, given.blade, depth, given.rake) for depth in given.cut]
    if given.depth is not None:
        found["depths"] = [layer(soil, gravity, depth, given.diameter[0]) for depth in given.depth]
    if given.json:
        print(json.dumps(found, indent=1))
        return 0
    relative = found["relative_density"]
    dense = "" if relative is None else f", relative density {relative:.2f}"
    print(f"soil {soil.name}: {soil.density:g} kg/m3{dense}; gravity {gravity:.3f} m/s2\n")
    print(f"round pads under {given.load:g} N, factor of safety {given.safety:g}")
    print_rows(found["pads"])
    print(f"\nshear under the first of them, {found['shear']['normal_pa'] / 1e3:.2f} kPa:")
    print_rows(
        [{"displacement_mm": mm, "stress_pa": pa} for mm, pa in zip(SHEARED, found["shear"]["stress_pa"], strict=True)]
    )
    print(f"\ndigging, {given.blade:g} m wide, rake {given.rake:g} degrees: a blade (McKyes), a bucket (Balovnev)")
    print_rows(found["digging"])
    if given.depth is not None:
        print("\nover depth (Lunar Sourcebook, ch. 9); a pad of the first diameter fails the soil there at")
        print_rows(found["depths"])
    return 0


def pad(soil: SoilParams, gravity: float, diameter: float, load: float, safety: float) -> dict[str, float]:
    """A round pad on the surface: pressures [kPa], safe load [N], sinkage, and rut when it is lifted again [mm]."""
    stands = pad_sinkage(soil, load, diameter)
    stiffness = modulus(soil, 0.5 * diameter)
    rut = rut_depth(stiffness, soil.n, stands, soil.unloading_stiffness, soil.unloading_stiffness_per_sinkage)
    return {
        "diameter_m": diameter,
        "pressure_kpa": pressure(soil, 0.5 * diameter, stands) / 1e3,
        "fails_at_kpa": ultimate_pressure(soil, diameter, gravity, "round") / 1e3,
        "safe_load_n": safe_load(soil, diameter, gravity, 0.0, safety),
        "sinkage_mm": 1e3 * stands,
        "rut_mm": 1e3 * rut,
    }


def shear(soil: SoilParams, normal: float) -> dict[str, Any]:
    """Shear stress [Pa] at `SHEARED` under a normal pressure [Pa]."""
    limit = shear_limit(soil.cohesion, soil.friction_angle, normal)
    stresses = [shear_stress(limit, 1e-3 * mm, soil.shear_modulus, soil.residual_shear_ratio) for mm in SHEARED]
    return {"normal_pa": normal, "displacement_mm": list(SHEARED), "stress_pa": stresses}


def digging(soil: SoilParams, gravity: float, width: float, depth: float, rake_deg: float) -> dict[str, float]:
    """What a blade and a bucket of a width [m] take along a cut of a depth [m]; the bucket is as long as it is wide.

    Raises:
        InvalidValueError: a width, depth or rake out of range.
    """
    rake, friction = math.radians(rake_deg), min(TOOL_FRICTION, soil.friction_angle)
    seen = DiggingSoil(soil.unit_weight(gravity), soil.cohesion, soil.friction_angle, friction)
    blade = mckyes(seen, width, depth, rake, sides=True)
    bucket = balovnev(seen, Bucket(width, width, BUCKET_WALL, BUCKET_WALL, 0.5 * math.pi), depth, rake)
    return {
        "cut_m": depth,
        "blade_n": blade.forward,
        "draws_in_n": blade.lift,
        "wedge_deg": math.degrees(blade.wedge),
        "bucket_n": bucket,
    }


def layer(soil: SoilParams, gravity: float, depth: float, diameter: float) -> dict[str, float]:
    """Lunar soil at a depth [m], and what a round pad there bears under the soil above it.

    Raises:
        InvalidValueError: a soil that is not lunar, or a depth that is not known.
    """
    if not soil.name.startswith(LUNAR):
        raise InvalidValueError("--depth of soil", soil.name, f"one whose name begins with {LUNAR}")
    there = soil_at(soil, depth)
    above = mean_density(depth) * gravity * depth
    return {
        "depth_m": depth,
        "density_kg_m3": there.density,
        "mean_density_kg_m3": mean_density(depth),
        "cohesion_pa": there.cohesion,
        "friction_angle_deg": there.friction_angle_deg,
        "fails_at_kpa": ultimate_pressure(there, diameter, gravity, "round", above) / 1e3,
    }


def _relative_density(soil: SoilParams) -> float | None:
    return None if soil.density_range is None else relative_density_at(soil.density, *soil.density_range)


def print_rows(rows: Sequence[dict[str, float]]) -> None:
    """Rows of one kind as a table; the unit is the end of each name."""
    table = Table(box=None, pad_edge=False)
    for name in rows[0]:
        table.add_column(escape(name), justify="right")
    for row in rows:
        table.add_row(*(f"{value:.4g}" for value in row.values()))
    print_table(table)


def run(given: argparse.Namespace) -> int:
    """Print the tables."""
    try:
        return _run(given)
    except MachineError as error:
        raise UsageError(str(error)) from error
