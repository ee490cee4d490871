"""Messages of /truth/ground that a test makes."""

import numpy as np

from sojourn_contract.ground import NAMES
from sojourn_contract.values import FLOAT32, PointCloud2, PointField
from sojourn_machine.params import FloatArray

_FIELDS = tuple(PointField(name, 4 * place, FLOAT32) for place, name in enumerate(NAMES))


def ground_told(stamp: int, nodes: FloatArray) -> PointCloud2:
    """Nodes that lie lower: x, y and by how much, (n, 3) [m]."""
    data = nodes.astype(np.float32).tobytes()
    return PointCloud2(stamp, "map", len(nodes), _FIELDS, 12, data, row_step=len(data))
