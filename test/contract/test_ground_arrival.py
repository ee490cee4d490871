"""Clouds on their arrival: by the fields that their rows name, not by those of another row."""

import numpy as np
import pytest

from sojourn_contract.arrival import check_input
from sojourn_contract.clouds import point_cloud
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.ground import GROUND, NAMES
from sojourn_contract.topics import topic
from sojourn_contract.values import FLOAT32, PointCloud2, PointField

FIELDS = tuple(PointField(name, 4 * place, FLOAT32) for place, name in enumerate(NAMES))


def ground(*nodes: tuple[float, float, float]) -> PointCloud2:
    data = np.array(nodes, dtype=np.float32).tobytes()
    return PointCloud2(20_000_000, "map", len(nodes), FIELDS, 12, data, row_step=len(data))


def test_ground_that_has_changed_is_taken() -> None:
    """It has no z: it was refused, and whoever looks at the ground saw that of the start."""
    check_input(GROUND, ground((1.0, 2.0, 0.01), (1.1, 2.0, -0.02)))
    check_input(GROUND, ground())


@pytest.mark.parametrize(("place", "name"), list(enumerate(NAMES)))
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_number_that_is_none_is_refused(place: int, name: str, value: float) -> None:
    node = [1.0, 2.0, 0.01]
    node[place] = value
    with pytest.raises(RefusedMessageError, match=rf"/truth/ground\.{name}\[1\]"):
        check_input(GROUND, ground((0.0, 0.0, 0.0), (node[0], node[1], node[2])))


def test_each_row_asks_for_its_own_fields() -> None:
    points = point_cloud(20_000_000, "base_link", np.ones((2, 3), dtype=np.float32))
    check_input(topic("/hazcam/points"), points)
    with pytest.raises(RefusedMessageError, match="x y lowered among them"):
        check_input(GROUND, points)
    with pytest.raises(RefusedMessageError, match="x y z among them"):
        check_input(topic("/hazcam/points"), ground((1.0, 2.0, 0.01)))
