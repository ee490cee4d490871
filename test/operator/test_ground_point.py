"""Where the ground is, against a search along the base's own axis, on slopes and tilted poses."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_operator.ground import ground_point
from sojourn_physics.terrain.height_field import HeightField

angle = st.floats(-0.4, 0.4)


@pytest.fixture(scope="module")
def terrain() -> HeightField:
    rough = ["terrain.resolution=0.2", "terrain.roughness.rms_slope_deg=8.0", "terrain.keep_clear=[]"]
    return load_scenario("lunar_sample", rough).height_field()


def search(
    terrain: HeightField, position: np.ndarray, rotation: np.ndarray, target: tuple[float, float, float]
) -> float:
    """Depth at which the base's z axis over (x, y) first meets the ground from above, by steps and bisection."""

    def over(depth: float) -> float:
        x, y, z = position + rotation @ np.array([*target[:2], depth])
        return z - terrain.height(x, y) - target[2]

    depths = np.arange(2.0, -3.0, -0.005)
    below = next(depth for depth in depths if over(depth) < 0.0)
    low, high = below, below + 0.005
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if over(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


@settings(max_examples=40)
@given(st.floats(2.0, 7.0), st.floats(-2.0, 2.0), st.floats(-3.1, 3.1), angle, angle, st.floats(0.0, 0.2))
def test_the_point_is_over_the_ground_at_the_wanted_height(
    terrain: HeightField, x: float, y: float, yaw: float, pitch: float, roll: float, height: float
) -> None:
    rotation = pin.rpy.rpyToMatrix(roll, pitch, yaw)
    position = np.array([x, y, terrain.height(x, y) + 0.4])
    target = (0.9, 0.2, height)
    point = ground_point(terrain, position, pin.Quaternion(rotation).coeffs(), target)
    in_map = position + rotation @ np.array(point)
    assert in_map[2] - terrain.height(in_map[0], in_map[1]) == pytest.approx(height, abs=1e-6)
    assert point[:2] == target[:2]
    assert point[2] == pytest.approx(search(terrain, position, rotation, target), abs=1e-6)


def test_on_flat_ground_it_is_plain_geometry() -> None:
    flat = load_scenario("flat_drive").height_field()
    pitch = 0.3
    rotation = pin.rpy.rpyToMatrix(0.0, pitch, 0.0)
    point = ground_point(flat, np.array([0.0, 0.0, 0.5]), pin.Quaternion(rotation).coeffs(), (0.8, 0.1, 0.05))
    # 0.5 - 0.8 sin(pitch) + z cos(pitch) = 0.05
    assert point[2] == pytest.approx((0.05 - 0.5 + 0.8 * np.sin(pitch)) / np.cos(pitch), abs=1e-9)
