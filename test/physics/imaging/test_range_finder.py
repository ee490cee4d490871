"""Range finders: what is the nearest in a cone, and what is read of it."""

import math
from typing import Any

import numpy as np
import pytest
from camera_scenes import MOON, NO_BODY, UNTOUCHED, flat, ground
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import BALL, Shapes
from sojourn_physics.imaging.range_finder import RangeFinderParams, cone_of, nearest_return
from sojourn_physics.imaging.scenery import Scenery
from sojourn_physics.terrain.height_field import HeightField

DOWN = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""From a frame whose x looks down into map."""


def finder(**told: Any) -> RangeFinderParams:
    return RangeFinderParams.model_validate({"nearest": 0.1, "range": 60.0, "noise": 0.0} | told)


def look(
    params: RangeFinderParams, field: HeightField, place: FloatArray, turn: FloatArray = DOWN, **more: Any
) -> float:
    """One reading."""
    met = Scenery(field, MOON).sound(cone_of(params), UNTOUCHED, more.get("body", NO_BODY), turn, place)
    return nearest_return(params, *met, np.random.default_rng(more.get("seed", 1)))


@given(st.floats(0.5, 120.0), st.integers(7, 2000))
def test_the_beams_of_a_cone_share_its_solid_angle_evenly(view_deg: float, count: int) -> None:
    directions = cone_of(finder(field_of_view_deg=view_deg, beams=count)).directions
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(count))
    assert directions[0] == pytest.approx([1.0, 0.0, 0.0])
    off = np.arccos(np.clip(directions[:, 0], -1.0, 1.0))
    assert off.max() == pytest.approx(math.radians(0.5 * view_deg), rel=1e-6)
    steps = np.diff(directions[:, 0])
    assert steps == pytest.approx(np.full(count - 1, steps[0]), abs=1e-12), "solid angle goes with the cosine"
    assert np.linalg.norm(directions[:, 1:].mean(axis=0)) < 1.1 * math.sin(math.radians(0.5 * view_deg)) / count**0.5


@settings(max_examples=25, deadline=None)
@given(st.floats(0.5, 4.0), st.floats(-25.0, 25.0), st.floats(1.0, 60.0))
def test_over_a_slope_a_cone_reads_the_nearest_of_it(height: float, slope_deg: float, view_deg: float) -> None:
    """Square to the slope where the cone is wide enough, else on its rim."""
    slope, half = math.radians(slope_deg), math.radians(0.5 * view_deg)
    field = ground(np.tile(0.1 * (np.arange(201) - 100.0) * math.tan(slope), (201, 1)), 0.1)
    read = look(finder(field_of_view_deg=view_deg, beams=1000), field, np.array([0.0, 0.0, height]))
    nearest = height * math.cos(slope)  # how far the plane is
    expected = nearest / math.cos(max(abs(slope) - half, 0.0))
    assert read == pytest.approx(expected, rel=0.004)
    assert read > nearest - 1e-3


def test_a_single_beam_reads_along_its_axis() -> None:
    aslant = math.radians(30.0)
    turn = np.array(
        [[math.sin(aslant), 0.0, math.cos(aslant)], [0.0, 1.0, 0.0], [-math.cos(aslant), 0.0, math.sin(aslant)]]
    )
    read = look(finder(), flat(), np.array([0.0, 0.0, 1.5]), turn)
    assert read == pytest.approx(1.5 / math.cos(aslant), abs=1e-3)
    assert look(finder(), flat(), np.array([0.0, 0.0, 1.5]), np.eye(3)) == math.inf, "nothing is before it"


def test_a_stone_beside_the_axis_is_nearer_than_the_ground() -> None:
    stone = Shapes(
        np.array([[BALL, 0.3, 0.3, 0.3, 0.3, 0.2]]), np.eye(3)[np.newaxis], np.array([[0.5, 0.0, 0.3]]),
        np.array([0.5, 0.0, 0.3, 0.3]),
    )  # fmt: skip
    place = np.array([0.0, 0.0, 3.0])
    assert look(finder(), flat(), place, body=stone) == pytest.approx(3.0, abs=1e-3)
    wide = look(finder(field_of_view_deg=30.0, beams=2000), flat(), place, body=stone)
    assert wide == pytest.approx(math.hypot(0.5, 2.7) - 0.3, abs=0.01)


def test_what_returns_little_is_heard_less_far() -> None:
    """Level ground is heard from R_0 sqrt(rho/rho_0): by light from its albedo, by radar from what is told."""
    for told, reflectance in (({}, MOON.albedo), ({"radiation": "radar", "target_reflectance": 0.07}, 0.07)):
        params = finder(range=20.0, reflectance=0.7, **told)
        farthest = 20.0 * math.sqrt(reflectance / 0.7)
        assert look(params, flat(), np.array([0.0, 0.0, 0.99 * farthest])) == pytest.approx(0.99 * farthest, abs=1e-3)
        assert look(params, flat(), np.array([0.0, 0.0, 1.01 * farthest])) == math.inf


def test_what_is_too_near_is_said_to_be() -> None:
    params = finder(nearest=0.5)
    assert look(params, flat(), np.array([0.0, 0.0, 0.49])) == -math.inf
    assert look(params, flat(), np.array([0.0, 0.0, 0.51])) == pytest.approx(0.51, abs=1e-3)


def test_errors_steps_and_losses_are_those_of_the_data_sheet() -> None:
    params = finder(noise=0.02, noise_per_metre=0.01, resolution=0.001, dropped=0.1, reflectance=0.1)
    random = np.random.default_rng(8)
    read = np.array([nearest_return(params, np.array([4.0]), np.array([0.1]), random) for _ in range(20_000)])
    heard = read[np.isfinite(read)]
    assert 1.0 - len(heard) / len(read) == pytest.approx(0.1, abs=0.01) and np.isposinf(read[~np.isfinite(read)]).all()
    assert heard.std() == pytest.approx(math.hypot(0.02, 0.04), rel=0.03) and heard.mean() == pytest.approx(
        4.0, abs=2e-3
    )
    assert heard * 1000.0 == pytest.approx(np.round(heard * 1000.0), abs=1e-6)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"nearest": 60.0}, "less than range"),
        ({"radiation": "radar"}, "no target_reflectance: needed with radiation = radar"),
        ({"radiation": "ultrasound"}, "the albedo is that of light"),
        ({"radiation": "smell"}, "infrared"),
        ({"field_of_view_deg": 170.0}, "field_of_view_deg"),
        ({"beams": 2}, "beams"),
    ],
)
def test_what_cannot_be_is_refused(told: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        finder(**told)
