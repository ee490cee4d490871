"""The star tracker: its data sheet over readings and seeds, and when it finds stars."""

from math import cos, inf, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import star_tracker
from sojourn_physics.sensors.star_tracker import StarTrackerParams, StarTrackerView

NST = StarTrackerParams(
    link="deck",
    cross_boresight_arcsec=6.0,
    about_boresight_arcsec=40.0,
    misalignment_arcsec=20.0,
    sun_exclusion_deg=45.0,
    horizon_exclusion_deg=25.0,
    slew_limit_deg_per_second=2.0,
)
ARCSEC = radians(1.0 / 3600.0)
UP = np.array([0.0, 0.0, 0.0, 1.0])


def sun_at(elevation_deg: float) -> FloatArray:
    elevation = radians(elevation_deg)
    return np.array([cos(elevation), 0.0, sin(elevation)])


VIEW = StarTrackerView(UP, 0.0, sun_at(10.0), 1.0, 0.0, False)


def test_noise_is_that_of_the_data_sheet_across_and_about_the_boresight() -> None:
    view = VIEW._replace(orientation=Rotation.from_euler("ZYX", [0.7, 0.3, -0.2]).as_quat())
    state, errors = star_tracker.initial_state(NST, 3, "stars"), []
    for _ in range(4000):
        state, reading = star_tracker.step(NST, state, view)
        assert reading is not None
        errors.append((Rotation.from_quat(view.orientation).inv() * Rotation.from_quat(reading)).as_rotvec())
    found = np.array(errors) / ARCSEC
    assert found.std(axis=0) == pytest.approx([6.0, 6.0, 40.0], rel=0.05)
    assert found.mean(axis=0) == pytest.approx(state.misalignment / ARCSEC, abs=3.0)


def test_the_lasting_error_over_seeds() -> None:
    drawn = [star_tracker.initial_state(NST, seed, "stars").misalignment for seed in range(500)]
    assert np.std(drawn) / ARCSEC == pytest.approx(20.0, rel=0.06)


@given(
    vector=st.tuples(*(st.floats(-3.0, 3.0),) * 3),
    cross=st.floats(0.0, 100.0),
    seed=st.integers(0, 100),
)
def test_a_reading_is_a_unit_quaternion_near_the_truth(
    vector: tuple[float, float, float], cross: float, seed: int
) -> None:
    params = NST.model_copy(update={"cross_boresight_arcsec": cross, "horizon_exclusion_deg": 0.0})
    true = Rotation.from_rotvec(vector)
    view = VIEW._replace(orientation=true.as_quat(), sun_seen=0.0, horizon=-inf)
    _, reading = star_tracker.step(params, star_tracker.initial_state(params, seed, "stars"), view)
    assert reading is not None
    assert float(reading @ reading) == pytest.approx(1.0, abs=1e-12)
    assert (true.inv() * Rotation.from_quat(reading)).magnitude() < 6.0 * (40.0 + 20.0 + cross) * ARCSEC


@pytest.mark.parametrize(
    ("change", "found"),
    [
        ({}, True),  # straight up, the Sun 80 deg off, no air
        ({"to_sun": sun_at(46.0)}, False),
        ({"to_sun": sun_at(44.0)}, True),
        ({"to_sun": sun_at(60.0), "sun_seen": 0.0}, True),  # behind a mountain
        ({"rate": radians(2.1)}, False),
        ({"rate": radians(1.9)}, True),
        ({"scattering_air": True}, False),
        ({"scattering_air": True, "to_sun": sun_at(-11.0), "sun_seen": 0.0}, False),
        ({"scattering_air": True, "to_sun": sun_at(-13.0), "sun_seen": 0.0}, True),
        ({"horizon": radians(64.0)}, True),
        ({"horizon": radians(66.0)}, False),
        ({"orientation": np.array([1.0, 0.0, 0.0, 0.0])}, False),  # upside down
        ({"orientation": np.array([1.0, 0.0, 0.0, 0.0]), "horizon": -inf}, True),  # in orbit
    ],
)
def test_when_it_finds_stars(change: dict[str, object], found: bool) -> None:
    state = star_tracker.initial_state(NST, 1, "stars")
    after, reading = star_tracker.step(NST, state, VIEW._replace(**change))
    assert (reading is not None) is found
    assert after.stream.row == state.stream.row + 1, "a bright sky shifts no later noise"


@pytest.mark.parametrize(
    "change", [{"orientation": np.zeros(4)}, {"orientation": np.full(4, np.nan)}, {"to_sun": np.zeros(3)}]
)
def test_bad_input_is_refused(change: dict[str, FloatArray]) -> None:
    with pytest.raises(InvalidValueError, match="star tracker"):
        star_tracker.step(NST, star_tracker.initial_state(NST, 1, "stars"), VIEW._replace(**change))
