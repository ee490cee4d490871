"""Every number of a message: finite unless its row says otherwise, and in the range that the table states."""

from collections.abc import Callable, Iterable, Sequence
from math import inf, isfinite, isinf, isnan
from operator import attrgetter
from typing import Any

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class

_FLOATS = ("double", "float")
_UNMEASURED = {"sensor_msgs/BatteryState": ("design_capacity", "cell_voltage", "cell_temperature")}
"""Fields that no row speaks of and that may be NaN: ROS says so of what is not measured."""


class NumberRule:
    """Finite numbers within their range.

    Args:
        row: topic whose numbers to judge.
    """

    name = "value"

    def __init__(self, row: Topic) -> None:
        self._fields = _Numbers(row.type, "", row)

    def judge(self, seen: Observation) -> list[Finding]:
        """Numbers that are not finite, or out of their range."""
        found: list[Finding] = []
        self._fields.judge(seen.message, "", found)
        return found


class _Numbers:
    """The numbers of one message type, at a place in a topic's message."""

    def __init__(self, type_name: str, place: str, row: Topic) -> None:
        self._scalars: list[tuple[str, FieldRule]] = []
        self._arrays: list[tuple[str, Callable[[Any], Any], FieldRule]] = []
        self._lists: list[tuple[str, _Numbers]] = []
        self._collect(type_name, "", place, row)
        paths = [path for path, _ in self._scalars]
        getter = attrgetter(*paths) if paths else None
        self._get: Callable[[Any], Sequence[float]] = _as_sequence(getter, len(paths))
        self._bounds = [(rule.low, rule.high) for _, rule in self._scalars]

    def judge(self, message: Any, place: str, found: list[Finding]) -> None:
        """Add what is wrong in `message`, which stands at `place`."""
        for index, (value, (low, high)) in enumerate(zip(self._get(message), self._bounds, strict=True)):
            if not low <= value <= high or value in (inf, -inf):
                path, rule = self._scalars[index]
                if not ((rule.optional and isnan(value)) or _is_no_distance(rule, value)):
                    found.append(_finding(place + path, float(value), rule))
        for path, get, rule in self._arrays:
            values = get(message)
            numbers = values.tolist() if hasattr(values, "tolist") else list(values)
            if numbers and not (rule.low <= min(numbers) and max(numbers) <= rule.high and isfinite(sum(numbers))):
                found.extend(_array_findings(message, place + path, numbers, rule))
        for path, inner in self._lists:
            for index, element in enumerate(getattr(message, path)):
                inner.judge(element, f"{place}{path}[{index}].", found)

    def _collect(self, type_name: str, path: str, place: str, row: Topic) -> None:
        """Walk through the definition of a type and keep its floating-point fields."""
        for name, kind in message_class(type_name).get_fields_and_field_types().items():
            here = f"{path}{name}"
            element = kind.removeprefix("sequence<").split(",")[0].rstrip(">").split("[")[0]
            is_many = element != kind
            if element in _FLOATS:
                rule = _rule(row, place + here)
                if is_many:
                    self._arrays.append((here, attrgetter(here), rule))
                else:
                    self._scalars.append((here, rule))
            elif "/" in element and not is_many:
                self._collect(element, here + ".", place, row)
            elif "/" in element:
                inner = _Numbers(element, f"{place}{here}.", row)
                if not inner.is_empty():
                    self._lists.append((here, inner))

    def is_empty(self) -> bool:
        """Whether there is no number in it."""
        return not (self._scalars or self._arrays or self._lists)


def _rule(row: Topic, path: str) -> FieldRule:
    """The rule of the table for a number at `path`, or one that only asks for finite."""
    for rule in row.fields:
        if path == rule.path or path.startswith(rule.path + "."):
            return rule
    return FieldRule(path, "", optional=path in _UNMEASURED.get(row.type, ()))


def _as_sequence(getter: "Callable[[Any], Any] | None", count: int) -> Callable[[Any], Sequence[float]]:
    if getter is None:
        return lambda message: ()
    if count == 1:
        return lambda message: (getter(message),)
    return getter


def _array_findings(message: Any, path: str, numbers: Iterable[float], rule: FieldRule) -> list[Finding]:
    names = list(getattr(message, "name", None) or getattr(message, "joint_names", None) or ())
    found = []
    for index, value in enumerate(numbers):
        if not rule.low <= value <= rule.high or not isfinite(value):
            if (rule.optional and isnan(value) and not names) or _is_no_distance(rule, value):
                continue
            where = names[index] if index < len(names) else index
            found.append(_finding(f"{path}[{where}]", float(value), rule))
    return found


def _is_no_distance(rule: FieldRule, value: float) -> bool:
    return rule.infinite and isinf(value)


def _finding(path: str, value: float, rule: FieldRule) -> Finding:
    if not isfinite(value):
        return Finding(path, value, "a finite number")
    excess = max(rule.low - value, value - rule.high)
    return Finding(path, value, f"{rule.low:g} to {rule.high:g} {rule.unit}".rstrip(), excess)
