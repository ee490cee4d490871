"""Matching a cloud with a surface: gradients by differences, shifts of a known ground, honest information."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rough_ground import CAMERA, STEREO, NoisyCamera, ground, nodes, rough

from sojourn_flight.hazards.stereo_camera import along_rays, height_variances
from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.ground_surface import GroundSurface, surface_through
from sojourn_flight.odometry.terrain_match import Match, match, normal_equations
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField


@pytest.fixture(scope="session")
def trust(drive_params: DriveParams) -> TerrainMatchParams:
    assert drive_params.terrain_match is not None
    return drive_params.terrain_match


def near(trust: TerrainMatchParams, cloud: FloatArray) -> FloatArray:
    return cloud[np.linalg.norm(cloud - CAMERA.position, axis=1) <= trust.range]


def surface_of(
    trust: TerrainMatchParams, field: HeightField, camera: NoisyCamera, x: float, y: float, yaw: float
) -> GroundSurface:
    """The ground about (x, y) in axes turned by yaw, as seen on the 0.3 m before it."""
    points, variances = [], []
    for back in (0.3, 0.2, 0.1, 0.0):
        before = (x - back * math.cos(yaw), y - back * math.sin(yaw))
        cloud = near(trust, camera.cloud(field, *before, yaw))
        lift = field.height(*before) - field.height(x, y)
        points.append(cloud + np.array((-back, 0.0, lift)))
        variances.append(height_variances(STEREO, cloud, np.array((0.0, 0.05, 1.0))) + 1e-6)
    return surface_through(np.concatenate(points), np.concatenate(variances), trust.cell, trust.radius, 3.0)


def matched(
    trust: TerrainMatchParams, surface: GroundSurface, cloud: FloatArray, guess: FloatArray, turn: float = 0.0
) -> Match:
    to_key = rotation_of(0.0, 0.0, turn)
    points = near(trust, cloud)
    sigmas = (trust.tilt_sigma, 1e-4)
    return match(surface, points @ to_key.T, along_rays(STEREO, points) @ to_key.T, guess, trust.sharing, sigmas)


def test_the_normal_equations_are_the_gradient_of_the_squares() -> None:
    """On a plane the weights are constant, so the right side is minus half the gradient of the sum of squares."""
    random = np.random.default_rng(1)
    places = random.uniform(-1.0, 1.0, (3000, 2))
    heights = 0.1 * places[:, 0] - 0.2 * places[:, 1]
    surface = surface_through(np.column_stack([places, heights]), np.full(3000, 1e-9), 0.08, 0.14, 1.2)
    points = random.uniform(-0.5, 0.5, (200, 3))
    points[:, 2] = points[:, :2] @ (0.1, -0.2) - 0.5 + 0.003 * random.standard_normal(200)
    errors = 5e-3 * (points - np.array((-1.0, 0.0, 0.5)))
    place = np.array((0.01, 0.02, 0.5))

    def equations(shift: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        matrix, side, _, count, outliers, squares = normal_equations(surface, points, errors, place, shift, 2.0)
        assert count == 200 and outliers == 0
        return matrix, side, squares

    matrix, side, _ = equations(np.zeros(6))
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-5
        (_, side_up, up), (_, side_down, down) = equations(step), equations(-step)
        assert side[i] == pytest.approx(-(up - down) / 4e-5, rel=1e-5, abs=1e-3)
        np.testing.assert_allclose(
            matrix[:, i], -(side_up - side_down) / 2e-5, rtol=0.05, atol=0.01 * abs(matrix).max()
        )


@settings(max_examples=15, deadline=None)
@given(
    st.floats(-0.05, 0.05), st.floats(-0.05, 0.05), st.floats(-0.03, 0.03), st.floats(-3.1, 3.1), st.floats(-0.2, 0.2)
)
def test_a_known_motion_is_found(
    trust: TerrainMatchParams, off_x: float, off_y: float, off_z: float, yaw: float, turn: float
) -> None:
    """Whatever the heading, the turn and the first guess: within five stated deviations and 4 cm."""
    field, camera = rough(3), NoisyCamera(4)
    surface = surface_of(trust, field, camera, 0.5, -0.5, yaw)
    x, y = 0.5 + 0.25 * math.cos(yaw), -0.5 + 0.25 * math.sin(yaw)
    cloud = camera.cloud(field, x, y, yaw + turn)
    truth = np.array((0.25, 0.0, field.height(x, y) - field.height(0.5, -0.5)))
    guess = truth + np.array((off_x, off_y, off_z))
    found = matched(trust, surface, cloud, guess, turn)
    error = (guess + found.shift[:3] - truth)[:2]
    assert found.converged and found.points > trust.least_points and found.misfit < 2.0
    assert error @ found.information @ error < 25.0
    assert np.linalg.norm(error) < 0.04


def test_the_stated_errors_are_right_over_grounds_and_noise(trust: TerrainMatchParams) -> None:
    """Squared errors over their covariance, two on average of two freedoms; and it must not hide behind large ones."""
    squares, sigmas = [], []
    for seed in range(40):
        field, camera = rough(seed), NoisyCamera(100 + seed)
        surface = surface_of(trust, field, camera, 0.0, 0.0, 0.0)
        guess = np.array((0.27, 0.02, field.height(0.3, 0.0) - field.height(0.0, 0.0)))
        found = matched(trust, surface, camera.cloud(field, 0.3, 0.0), guess)
        error = (guess + found.shift[:3])[:2] - (0.3, 0.0)
        squares.append(error @ found.information @ error)
        sigmas.append(1.0 / math.sqrt(max(np.linalg.eigvalsh(found.information).min(), 1e-9)))
    assert 0.5 < np.mean(squares) < 2.6
    assert np.mean(np.array(squares) < 5.991) >= 0.9
    assert np.median(sigmas) < 0.012


@pytest.mark.parametrize("slope", [0.0, 0.1])
def test_an_even_ground_says_nothing(trust: TerrainMatchParams, slope: float) -> None:
    field = ground(slope * nodes()[0])
    for seed in range(8):
        camera = NoisyCamera(seed)
        surface = surface_of(trust, field, camera, 0.0, 0.0, 0.0)
        found = matched(trust, surface, camera.cloud(field, 0.3, 0.0), np.array((0.3, 0.0, slope * 0.3)))
        assert np.linalg.eigvalsh(found.information).max() < 0.03**-2


def test_a_corrugated_ground_says_nothing_along_its_ridges(trust: TerrainMatchParams) -> None:
    field, camera = ground(0.04 * np.sin(5.0 * nodes()[0])), NoisyCamera(1)
    surface = surface_of(trust, field, camera, 0.0, 0.0, 0.0)
    guess = np.array((0.28, 0.0, field.height(0.3, 0.0) - field.height(0.0, 0.0)))
    found = matched(trust, surface, camera.cloud(field, 0.3, 0.0), guess)
    assert guess[0] + found.shift[0] == pytest.approx(0.3, abs=0.01)
    values, axes = np.linalg.eigh(found.information)
    assert values[1] > 0.005**-2 and abs(axes[0, 1]) > 0.99
    assert values[0] < 0.03**-2


def test_a_cloud_of_another_ground_does_not_fit(trust: TerrainMatchParams) -> None:
    camera = NoisyCamera(1)
    surface = surface_of(trust, rough(1, 4.0), camera, 0.0, 0.0, 0.0)
    found = matched(trust, surface, camera.cloud(rough(2, 4.0), 0.0, 0.0), np.array((0.0, 0.0, 0.0)))
    bad = found.outliers > 0.25 * found.points or found.misfit > trust.misfit or not found.converged
    assert bad
