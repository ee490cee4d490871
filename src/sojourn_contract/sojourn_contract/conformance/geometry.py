"""Orientations of unit length and covariances that can be: symmetric, with no negative variance."""

from collections.abc import Callable
from math import isclose, sqrt
from operator import attrgetter
from typing import Any

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.topic_types import Topic

UNIT_TOLERANCE = 1e-3
"""Largest difference of a quaternion's length from one."""
SYMMETRY_TOLERANCE = 1e-9
"""Largest difference of two elements of a covariance across its diagonal, relative to the largest element."""
_ORIENTATIONS = {
    "nav_msgs/OccupancyGrid": "info.origin.orientation",
    "nav_msgs/Odometry": "pose.pose.orientation",
    "sensor_msgs/Imu": "orientation",
    "geometry_msgs/PoseStamped": "pose.orientation",
    "geometry_msgs/PoseWithCovarianceStamped": "pose.pose.orientation",
}
_COVARIANCES = {
    "geometry_msgs/PoseWithCovarianceStamped": (("pose.covariance", 6),),
    "nav_msgs/Odometry": (("pose.covariance", 6), ("twist.covariance", 6)),
    "sensor_msgs/Imu": (
        ("orientation_covariance", 3),
        ("angular_velocity_covariance", 3),
        ("linear_acceleration_covariance", 3),
    ),
}


class OrientationRule:
    """Quaternions of one topic. A goal may leave its heading free with one of all zeros."""

    name = "orientation"

    def __init__(self, row: Topic) -> None:
        self._path = _ORIENTATIONS[row.type]
        self._get: Callable[[Any], Any] = attrgetter(self._path)
        self._zero_too = row.is_event

    @staticmethod
    def applies(row: Topic) -> bool:
        """Whether messages of this row hold an orientation."""
        return row.type in _ORIENTATIONS

    def judge(self, seen: Observation) -> tuple[Finding, ...]:
        """An orientation that is no rotation."""
        q = self._get(seen.message)
        length = sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
        if isclose(length, 1.0, abs_tol=UNIT_TOLERANCE, rel_tol=0.0) or length != length:
            return ()
        if self._zero_too and length == 0.0:
            return ()
        allowed = "length 1" + (", or all zeros" if self._zero_too else "")
        return (Finding(self._path, f"of length {length:.6g}", allowed, abs(length - 1.0)),)


class CovarianceRule:
    """Covariances of one topic. One that begins with -1 is not known (sensor_msgs/Imu)."""

    name = "covariance"

    def __init__(self, row: Topic) -> None:
        self._fields = [(path, attrgetter(path), size) for path, size in _COVARIANCES[row.type]]
        self._good: dict[str, list[float]] = {}

    @staticmethod
    def applies(row: Topic) -> bool:
        """Whether messages of this row hold covariances."""
        return row.type in _COVARIANCES

    def judge(self, seen: Observation) -> list[Finding]:
        """What is wrong with the covariances."""
        found: list[Finding] = []
        for path, get, size in self._fields:
            values = get(seen.message).tolist()
            if values != self._good.get(path) and values[0] != -1.0:
                wrong = _covariance(path, values, size)
                found += wrong
                if not wrong:
                    self._good[path] = values
        return found


def _covariance(path: str, values: list[float], size: int) -> list[Finding]:
    diagonal = values[:: size + 1]
    if min(diagonal) < 0.0:
        place = diagonal.index(min(diagonal))
        return [Finding(f"{path}[{place * (size + 1)}]", min(diagonal), "no negative variance", -min(diagonal))]
    slack = SYMMETRY_TOLERANCE * max(max(values), -min(values))
    for row in range(1, size):
        for column in range(row):
            difference = abs(values[row * size + column] - values[column * size + row])
            if difference > slack:
                value, other = values[row * size + column], values[column * size + row]
                return [Finding(f"{path}[{row * size + column}]", value, f"{other:g}, as across", difference)]
    return []
