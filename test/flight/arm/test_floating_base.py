"""A base that gives way: foretold along a way of the joints, and found again by its centre of mass."""

from functools import lru_cache

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.flight import FlightScenario
from sojourn_config.scenario import load_flight
from sojourn_flight.arm.floating_base import FloatingBase
from sojourn_machine.params import FloatArray

SEEDS = st.integers(0, 2**31)


@lru_cache
def servicer() -> FlightScenario:
    return load_flight("servicer_course")


@lru_cache
def floating() -> FloatingBase:
    return FloatingBase(servicer().urdf_xml, servicer().carried_arm())


def postures(seed: int) -> tuple[FloatArray, FloatArray]:
    draw = np.random.default_rng(seed)
    return draw.uniform(-2.0, 2.0, 6), draw.uniform(-2.0, 2.0, 6)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_where_the_base_is_foretold_the_centre_of_mass_has_not_moved(seed: int) -> None:
    before, after = postures(seed)
    base = floating().foretold(before, after)
    found = floating().given_way(before, after, base.rotation)
    assert np.linalg.norm(base.translation) > 1e-4
    np.testing.assert_allclose(found.translation, base.translation, atol=1e-4)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_the_way_back_brings_the_base_back_and_its_parts_make_the_whole(seed: int) -> None:
    before, after = postures(seed)
    there, back = floating().foretold(before, after), floating().foretold(after, before)
    np.testing.assert_allclose((there * back).homogeneous, np.eye(4), atol=2e-5)
    half = 0.5 * (before + after)
    parts = floating().foretold(before, half) * floating().foretold(half, after)
    np.testing.assert_allclose(parts.homogeneous, there.homogeneous, atol=2e-5)


def test_a_base_without_end_of_mass_stands() -> None:
    urdf = (
        servicer()
        .urdf_xml.replace('<mass value="500"', '<mass value="5e9"')
        .replace(
            'ixx="120" ixy="0" ixz="0" iyy="120" iyz="0" izz="120"',
            'ixx="1e9" ixy="0" ixz="0" iyy="1e9" iyz="0" izz="1e9"',
        )
    )
    assert urdf != servicer().urdf_xml
    base = FloatingBase(urdf, servicer().carried_arm()).foretold(*postures(1))
    assert np.linalg.norm(pin.log6(base).vector) < 1e-6
