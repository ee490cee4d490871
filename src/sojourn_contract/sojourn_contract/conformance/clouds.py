"""Clouds of points: the fields that the contract names, as many points as it says, numbers in their range."""

from typing import Any

import numpy as np

from sojourn_contract.clouds import columns_of
from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.conformance.ros_reading import cloud_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import PointCloud2


class CloudRule:
    """The clouds of one topic.

    Args:
        row: the topic; its rules name the fields, in their order. points: how many each cloud has, None for any number.
    """

    name = "cloud"

    def __init__(self, row: Topic, points: int | None) -> None:
        self._points = points
        self._topic = row.name
        self._fields = tuple(name for rule in row.fields for name in rule.path.split())
        self._rules = [rule for rule in row.fields for _ in rule.path.split()]
        self._low = np.array([rule.low for rule in self._rules])
        self._high = np.array([rule.high for rule in self._rules])

    def judge(self, seen: Observation) -> list[Finding]:
        """What is wrong with the cloud's shape, or with its numbers."""
        cloud = cloud_of(seen.message)
        names = tuple(field.name for field in cloud.fields)
        if names != self._fields:
            return [Finding("fields", " ".join(names), " ".join(self._fields))]
        points = cloud.width * cloud.height
        if self._points is not None and points != self._points:
            return [Finding("width", points, f"{self._points} points, one a wheel or pad", abs(points))]
        return self._numbers(cloud)

    def _numbers(self, cloud: PointCloud2) -> list[Finding]:
        try:
            columns = columns_of(self._topic, cloud, self._fields)
        except RefusedMessageError as refusal:
            return [Finding.of_refusal(refusal)]
        values = np.array([columns[name] for name in self._fields], dtype=np.float64).T
        bad = ~((values >= self._low) & (values <= self._high) & np.isfinite(values))
        if not bad.any():
            return []
        return [self._finding(int(point), int(column), values) for point, column in np.argwhere(bad)]

    def _finding(self, point: int, column: int, values: Any) -> Finding:
        rule: FieldRule = self._rules[column]
        value = float(values[point, column])
        allowed = f"{rule.low:g} to {rule.high:g} {rule.unit}"
        excess = max(rule.low - value, value - rule.high) if np.isfinite(value) else float("inf")
        return Finding(f"{self._fields[column]}[{point}]", value, allowed, excess)
