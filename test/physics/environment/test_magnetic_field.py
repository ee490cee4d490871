"""The magnetic field of a body: against the gradient of its potential, published fields and poles."""

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.paths import config_folder
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.magnetic_field import MagneticDipoleParams
from sojourn_physics.environment.site import SiteParams

EARTH_POLE = (80.65, -72.68)
"""Geomagnetic north pole of IGRF-13 for 2020 (British Geological Survey) [deg]."""
BODIES = {
    name: BodyParams.model_validate(yaml.safe_load((config_folder() / "bodies" / f"{name}.yaml").read_text("utf-8")))
    for name in ("earth", "mercury", "ganymede", "jupiter", "moon")
}
angles = st.tuples(st.floats(-89.0, 89.0), st.floats(-180.0, 180.0))


def potential(dipole: MagneticDipoleParams, place: FloatArray) -> float:
    """Degree one of the spherical harmonics, by colatitude and longitude about the dipole's place [T m]."""
    g10, g11, h11 = dipole.gauss_coefficients
    x, y, z = place - np.array([0.0, 0.0, dipole.offset_north])
    radius = np.sqrt(x * x + y * y + z * z)
    colatitude, longitude, a = np.arccos(z / radius), np.arctan2(y, x), dipole.reference_radius
    across = g11 * np.cos(longitude) + h11 * np.sin(longitude)
    return float(a * (a / radius) ** 2 * (g10 * np.cos(colatitude) + across * np.sin(colatitude)))


@pytest.mark.parametrize("name", ["earth", "mercury", "ganymede", "jupiter"])
@given(where=angles)
def test_field_is_minus_the_gradient_of_its_potential(name: str, where: tuple[float, float]) -> None:
    dipole = BODIES[name].magnetic_dipole
    assert dipole is not None
    latitude, longitude = np.radians(where)
    level = np.cos(latitude)
    place = 1.1 * dipole.reference_radius * np.array(
        [level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)]
    )  # fmt: skip
    step = 1e-4 * dipole.reference_radius
    gradient = [potential(dipole, place + step * axis) - potential(dipole, place - step * axis) for axis in np.eye(3)]
    field = dipole.field_at(place)
    np.testing.assert_allclose(field, -np.array(gradient) / (2.0 * step), atol=1e-6 * np.linalg.norm(field))


def test_earth_points_straight_down_at_the_geomagnetic_pole_and_north_at_the_equator() -> None:
    earth = BODIES["earth"]
    pole = earth.magnetic_field_over(SiteParams(latitude_deg=EARTH_POLE[0], longitude_deg=EARTH_POLE[1]))
    assert pole[2] < 0.0 and np.hypot(*pole[:2]) < 0.01 * abs(pole[2])  # of the sphere; the vertical is the ellipsoid's
    assert -pole[2] == pytest.approx(2 * 29_806e-9, rel=0.02)  # 7.7e22 A m2 over 4 pi 1e-7 r3
    magnetic_equator = earth.magnetic_field_over(SiteParams(latitude_deg=-9.35, longitude_deg=-72.68))
    assert magnetic_equator[1] == pytest.approx(29_806e-9, rel=0.01) and abs(magnetic_equator[2]) < 3e-7


@pytest.mark.published
def test_mercury_is_three_times_as_strong_at_its_north_pole_as_at_its_south_pole() -> None:
    """The offset of 0.196 radii: (1.196 / 0.804)^3 = 3.3 (Anderson et al. 2011, Science 333:1859: some 3.4)."""
    north, south = (
        float(np.linalg.norm(BODIES["mercury"].magnetic_field_over(SiteParams(latitude_deg=angle))))
        for angle in (90.0, -90.0)
    )
    assert north / south == pytest.approx(3.3, abs=0.1)


def test_ganymede_has_719_nanotesla_at_its_magnetic_equator_and_is_tilted_by_176_degrees() -> None:
    dipole = BODIES["ganymede"].magnetic_dipole
    assert dipole is not None
    g10, g11, h11 = dipole.gauss_coefficients
    assert np.sqrt(g10**2 + g11**2 + h11**2) == pytest.approx(719e-9, abs=0.5e-9)
    assert np.degrees(np.arctan2(np.hypot(g11, h11), g10)) == pytest.approx(176.0, abs=0.5)
    assert np.degrees(np.arctan2(h11, g11)) == pytest.approx(24.0, abs=0.5)


def test_a_body_without_a_dipole_has_none_and_one_with_asks_for_a_site() -> None:
    assert not BODIES["moon"].magnetic_field_over(None).any()
    with pytest.raises(InvalidValueError, match=r"site.*differs from place to place"):
        BODIES["earth"].magnetic_field_over(None)


def test_the_middle_of_a_dipole_is_refused() -> None:
    dipole = MagneticDipoleParams(gauss_coefficients=(1e-5, 0.0, 0.0), reference_radius=1e6)
    with pytest.raises(InvalidValueError, match="distance from the dipole"):
        dipole.field_at(np.array([0.0, 0.0, 100.0]))
