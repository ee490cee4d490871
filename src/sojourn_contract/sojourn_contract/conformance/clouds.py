"""Clouds of contacts: the fields that the contract names, one point a wheel or pad, numbers in their range."""

from typing import Any

import numpy as np

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.messages import CONTACT_FIELDS
from sojourn_contract.topic_types import FieldRule, Topic

_CODES = {7: "f4", 8: "f8"}
"""Floating-point types of a sensor_msgs/PointField."""


class CloudRule:
    """The contacts of the plant.

    Args:
        row: the topic. contacts: how many points each cloud has.
    """

    name = "cloud"

    def __init__(self, row: Topic, contacts: int) -> None:
        self._contacts = contacts
        rules = {name: rule for rule in row.fields for name in rule.path.split()}
        self._rules = [rules[name] for name in CONTACT_FIELDS]
        self._low = np.array([rule.low for rule in self._rules])
        self._high = np.array([rule.high for rule in self._rules])

    def judge(self, seen: Observation) -> list[Finding]:
        """What is wrong with the cloud's shape, or with its numbers."""
        cloud = seen.message
        names = tuple(field.name for field in cloud.fields)
        if names != CONTACT_FIELDS:
            return [Finding("fields", " ".join(names), " ".join(CONTACT_FIELDS))]
        points = cloud.width * cloud.height
        if points != self._contacts:
            return [Finding("width", points, f"{self._contacts} points, one a wheel or pad", abs(points))]
        if len(cloud.data) != points * cloud.point_step:
            return [Finding("data", f"{len(cloud.data)} bytes", f"{points} points of {cloud.point_step} bytes")]
        return self._numbers(cloud)

    def _numbers(self, cloud: Any) -> list[Finding]:
        order = ">" if cloud.is_bigendian else "<"
        for field in cloud.fields:
            if field.datatype not in _CODES or field.count != 1 or field.offset + 4 > cloud.point_step:
                return [Finding(f"fields.{field.name}", f"datatype {field.datatype}", "one float64 or float32")]
        dtype = np.dtype(
            {
                "names": [field.name for field in cloud.fields],
                "formats": [order + _CODES[field.datatype] for field in cloud.fields],
                "offsets": [field.offset for field in cloud.fields],
                "itemsize": cloud.point_step,
            }
        )
        points = np.frombuffer(bytes(cloud.data), dtype=dtype)
        values = np.array([points[name] for name in CONTACT_FIELDS], dtype=np.float64).T
        bad = ~((values >= self._low) & (values <= self._high) & np.isfinite(values))
        if not bad.any():
            return []
        return [self._finding(int(point), int(column), values) for point, column in np.argwhere(bad)]

    def _finding(self, point: int, column: int, values: Any) -> Finding:
        rule: FieldRule = self._rules[column]
        value = float(values[point, column])
        allowed = f"{rule.low:g} to {rule.high:g} {rule.unit}"
        excess = max(rule.low - value, value - rule.high) if np.isfinite(value) else float("inf")
        return Finding(f"{CONTACT_FIELDS[column]}[{point}]", value, allowed, excess)
