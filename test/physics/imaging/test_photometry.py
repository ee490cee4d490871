"""Reflectances: reciprocal, no more light than comes in, and what scales them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_physics.imaging.photometry import HAPKE_AT_30, Look, hapke, reflectance

COSINES = st.floats(0.05, 1.0)
SINGLE = 2.0 * float(np.finfo(np.float32).eps)
"""The constants are of this precision [-]."""
LOOKS = pytest.mark.parametrize("regolith", [0.0, 1.0])


def test_the_scale_is_that_of_the_law_at_thirty_degrees() -> None:
    cosine = math.cos(math.radians(30.0))
    assert math.pi * hapke(cosine, 1.0, cosine) == pytest.approx(HAPKE_AT_30, rel=SINGLE)
    assert reflectance(Look(0.12, 1.0), cosine, 1.0, cosine) == pytest.approx(0.12 / math.pi, rel=SINGLE)


@LOOKS
@given(mu0=COSINES, mu=COSINES, cos_phase=st.floats(-1.0, 1.0))
def test_light_goes_back_the_way_it_came(regolith: float, mu0: float, mu: float, cos_phase: float) -> None:
    """Helmholtz: r / mu0 is the same with the two angles changed over."""
    look = Look(0.2, regolith)
    forth, back = reflectance(look, mu0, mu, cos_phase), reflectance(look, mu, mu0, cos_phase)
    assert forth / mu0 == pytest.approx(back / mu, rel=1e-9) and forth > 0.0


@LOOKS
@pytest.mark.parametrize("incidence_deg", [0.0, 40.0, 70.0])
def test_no_more_leaves_than_comes(regolith: float, incidence_deg: float) -> None:
    """The light that leaves into the half space, by quadrature, for the brightest soil there is."""
    incidence = math.radians(incidence_deg)
    sun = np.array([math.sin(incidence), 0.0, math.cos(incidence)])
    emission, azimuth = np.meshgrid((np.arange(60) + 0.5) * math.pi / 120, (np.arange(90) + 0.5) * math.pi / 45)
    sent = 0.0
    for e, a in zip(emission.ravel(), azimuth.ravel(), strict=True):
        away = np.array([math.sin(e) * math.cos(a), math.sin(e) * math.sin(a), math.cos(e)])
        part = reflectance(Look(0.3, regolith), sun[2], away[2], float(sun @ away))
        sent += part * math.cos(e) * math.sin(e) * (math.pi / 120) * (math.pi / 45)
    assert sent < sun[2]
    if regolith == 0.0:
        assert sent == pytest.approx(0.3 * sun[2], rel=1e-3)


def test_regolith_is_bright_with_the_sun_behind_and_the_matt_one_is_not() -> None:
    def ratio(regolith: float) -> float:
        look = Look(0.12, regolith)
        behind, ahead = math.cos(0.0), math.cos(math.radians(120.0))
        return reflectance(look, 0.5, 0.5, behind) / reflectance(look, 0.5, 0.5, ahead)

    assert ratio(1.0) > 4.0 and ratio(0.0) == 1.0


def test_ground_that_faces_away_is_dark() -> None:
    assert reflectance(Look(0.1, 1.0), -0.1, 0.5, 0.3) == 0.0
