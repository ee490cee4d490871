"""Track against closed forms: even pressure, turn on the spot, resistances, road wheels."""

import math
from collections.abc import Callable
from typing import Any

import pytest
from scipy.integrate import quad

from sojourn_analysis.wheels.examples import TRACK, TRACK_SIZE, example_row
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.track import LevelTrackColumn, track_shear
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

Maker = Callable[..., Any]
LENGTH, WIDTH = TRACK.length, TRACK_SIZE["width"]


def even() -> FloatArray:
    row = example_row("track")
    row[LevelTrackColumn.PEAKEDNESS] = 0.0
    return row


@pytest.mark.parametrize("slip", [0.03, 0.2, 0.7])
def test_thrust_under_even_pressure_is_janosis_closed_form(law: Maker, slip: float) -> None:
    one = law(even(), "lunar_nominal")
    depth = 0.01
    found = one.step(30000, penetration=depth, v_along=0.5 * (1.0 - slip), rim_speed=0.5)
    modulus, load = one.soil[SoilColumn.SHEAR_MODULUS], found["force_z"]
    assert load == pytest.approx(WIDTH * LENGTH * pressure_modulus(one.soil, WIDTH) * depth)
    strength = WIDTH * LENGTH * one.soil[SoilColumn.COHESION] + load * one.soil[SoilColumn.TAN_PHI]
    j = slip * LENGTH / modulus
    thrust = strength * (1.0 - (1.0 - math.exp(-j)) / j)
    assert found["torque"] / TRACK_SIZE["radius"] == pytest.approx(thrust, rel=1e-3)


def test_resistances_are_those_of_compaction_and_of_a_wall(law: Maker) -> None:
    one = law(even(), "lunar_nominal")
    found = one.step(30000, penetration=0.02, v_along=0.5, rim_speed=0.5)
    k, n = pressure_modulus(one.soil, WIDTH), one.soil[SoilColumn.N]
    compaction = WIDTH * quad(lambda z: k * z**n, 0.0, 0.02)[0]
    weight = one.soil[SoilColumn.DENSITY] * 1.62
    wall = WIDTH * wall_resistance(0.02, one.soil[SoilColumn.COHESION], one.soil[SoilColumn.TAN_PHI], weight)
    assert found["compaction_resistance"] == pytest.approx(compaction, rel=1e-6)
    assert found["bulldozing_resistance"] == pytest.approx(wall, rel=1e-6)
    assert found["force_x"] == pytest.approx(-compaction - wall, rel=1e-3)


def test_a_turn_on_the_spot_meets_the_friction_of_its_length(law: Maker) -> None:
    """Sliding all along: mu W l / 4."""
    one = law(even(), "lunar_nominal")
    soil = one.soil.copy()
    soil[SoilColumn.COHESION] = 0.0
    soil[[SoilColumn.SHEAR_MODULUS, SoilColumn.SHEAR_MODULUS_LATERAL]] = 1e-4
    found = law(even(), soil).step(4000, penetration=0.01, yaw_rate=0.5)
    expected = soil[SoilColumn.TAN_PHI] * found["force_z"] * LENGTH / 4.0
    assert found["moment_z"] == pytest.approx(-expected, rel=0.01)
    assert abs(found["force_y"]) < 1e-9 * found["force_z"]


def test_a_turning_track_pushes_against_its_turn(law: Maker) -> None:
    one = law("track", "sandy_loam")
    left = one.step(20000, penetration=0.01, v_along=0.4, rim_speed=0.45, yaw_rate=0.2)
    one.state[:] = 0.0
    right = one.step(20000, penetration=0.01, v_along=0.4, rim_speed=0.45, yaw_rate=-0.2)
    assert left["moment_z"] < 0.0 < right["moment_z"]
    assert left["moment_z"] == pytest.approx(-right["moment_z"])
    assert left["force_x"] == pytest.approx(right["force_x"])


def test_road_wheels_sink_deeper_and_leave_the_load_as_it_is(law: Maker) -> None:
    """Pressure with peaks: the same load needs the sinkage of its greatest pressure."""
    load = 300.0
    depths = []
    for row in (even(), example_row("track")):
        depths.append(law(row, "lunar_nominal").penetration_for(load))
    assert depths[1] == pytest.approx(depths[0] * (1.0 + TRACK.peakedness), rel=1e-6)  # n = 1


@pytest.mark.parametrize("wheels", [1, 5, 8])
def test_shear_with_peaks_is_the_integral_along_the_track(law: Maker, wheels: int) -> None:
    row = example_row("track")
    row[LevelTrackColumn.ROAD_WHEELS] = wheels
    soil = law(row, "dry_sand").soil
    k_x, k_y = soil[SoilColumn.SHEAR_MODULUS], soil[SoilColumn.SHEAR_MODULUS_LATERAL]
    mean, slip, side, turn = 3e3, 0.15, 0.05, 0.3

    def shear(x: float) -> tuple[float, float]:
        pressure = mean * (1.0 - TRACK.peakedness * math.cos(2.0 * math.pi * wheels * (x / LENGTH + 0.5)))
        passed = 0.5 * LENGTH - x
        j_x, j_y = slip * passed / k_x, (side + turn * x) * passed / k_y
        j = math.hypot(j_x, j_y)
        tau = (soil[SoilColumn.COHESION] + pressure * soil[SoilColumn.TAN_PHI]) * (1.0 - math.exp(-j))
        return WIDTH * tau * j_x / j, WIDTH * tau * j_y / j

    half = 0.5 * LENGTH - 1e-12
    options = {"epsabs": 1e-6, "limit": 200}
    expected = (
        quad(lambda x: shear(x)[0], -half, half, **options)[0],
        quad(lambda x: shear(x)[1], -half, half, **options)[0],
        quad(lambda x: x * shear(x)[1], -half, half, **options)[0],
    )
    found = track_shear(row, soil, mean, slip, side, turn, 1.0)
    assert found[:2] == pytest.approx(expected[:2], abs=1e-3 * math.hypot(*expected[:2]))
    assert found[2] == pytest.approx(expected[2], abs=1e-3 * LENGTH * math.hypot(*expected[:2]))
