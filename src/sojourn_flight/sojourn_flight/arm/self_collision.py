"""Whether an arm as it is read from a URDF runs into itself, or into what carries it.

Signed distances between primitive shapes (GJK/EPA; the coal library through Pinocchio), for the pairs of
collision_pairs.py. Meshes are left out, and so are pairs that overlap in every one of `POSTURES` evenly spread
postures: housings that stand in each other by design.
"""

from typing import Any

import numpy as np
import pinocchio

from sojourn_flight.arm.collision_pairs import link_name
from sojourn_flight.arm.inverse_search import spread
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray

POSTURES = 16


class SelfCollision:
    """Looks for collisions of an arm. Without shapes it finds none."""

    def __init__(self, arm: SerialArm) -> None:
        self._arm = arm
        self._shapes: Any = arm.shapes
        self._data = self._shapes.createData()
        postures = spread(arm.joint_count, POSTURES) * (arm.upper - arm.lower) + arm.lower
        count = len(self._shapes.collisionPairs)
        overlap = np.array([self._distances(row) < 0.0 for row in postures]).reshape(POSTURES, count)
        self._checked = ~np.all(overlap, axis=0)

    @property
    def pairs(self) -> int:
        """How many pairs of shapes are looked at."""
        return int(np.count_nonzero(self._checked))

    def at(self, positions: FloatArray) -> tuple[str, str, float] | None:
        """The two links that overlap most at joint positions (n,), and how deep [m]; None where none do."""
        distances = np.where(self._checked, self._distances(positions), np.inf)
        if not distances.size or distances.min() >= 0.0:
            return None
        worst = int(np.argmin(distances))
        pair, objects = self._shapes.collisionPairs[worst], self._shapes.geometryObjects
        names = [
            link_name(self._arm.pinocchio_model, objects[index].parentFrame) for index in (pair.first, pair.second)
        ]
        return names[0], names[1], -float(distances[worst])

    def text(self, positions: FloatArray) -> str:
        """The same in words; empty where nothing collides."""
        found = self.at(positions)
        return "" if found is None else f"{found[0]} and {found[1]} overlap by {found[2]:.3g} m"

    def _distances(self, positions: FloatArray) -> FloatArray:
        model = self._arm.pinocchio_model
        pinocchio.updateGeometryPlacements(model, self._arm.data, self._shapes, self._data, positions)
        pinocchio.computeDistances(self._shapes, self._data)
        return np.array([result.min_distance for result in self._data.distanceResults])
