"""How a machine stands on ground that does not give way."""

import math

import numpy as np
import pytest

from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.standing_ground import StandingGround

SUPPORTS = np.array([(0.7, 0.5), (0.7, -0.5), (-0.7, 0.5), (-0.7, -0.5), (0.0, 0.5), (0.0, -0.5)])


@pytest.mark.parametrize("yaw", [0.0, 1.2, -2.6])
def test_it_stands_on_the_plane_under_its_supports(yaw: float) -> None:
    y, x = np.mgrid[-5.0:5.01:0.1, -5.0:5.01:0.1]
    field = HeightField(1.0 + 0.2 * x - 0.1 * y, np.zeros(x.shape, dtype=np.uint8), 0.1, -5.0, -5.0, ("one",))
    position, roll, pitch = StandingGround(field, SUPPORTS, 0.4).pose(1.0, 2.0, yaw)
    assert position == pytest.approx([1.0, 2.0, 1.0 + 0.2 - 0.2 + 0.4])
    # slopes along and across its heading: of the plane's gradient (0.2, -0.1)
    assert math.tan(-pitch) == pytest.approx(0.2 * math.cos(yaw) - 0.1 * math.sin(yaw))
    assert math.tan(roll) == pytest.approx(-0.2 * math.sin(yaw) - 0.1 * math.cos(yaw))
