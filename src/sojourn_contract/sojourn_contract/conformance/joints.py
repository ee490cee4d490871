"""Joints: names that the rover has, one number for each name, and angles and rates that its joints can have."""

from collections.abc import Iterable, Iterator
from typing import Any

from sojourn_config.urdf import UrdfJoint
from sojourn_contract.checks import check_message, check_names
from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.conformance.ros_reading import trajectory_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic

ANGLE_MARGIN = 0.1
"""How far a joint may be beyond its stop, which is not stiff without end [rad]."""
RATE_FACTOR = 3.0
"""Rates above so many times the URDF's limit are not plausible; a servo overshoots it by half."""


class JointRule:
    """Names and array lengths of a message that names joints.

    Args:
        row: its topic. machine: the rover.
    """

    name = "joints"

    def __init__(self, row: Topic, machine: JudgedMachine) -> None:
        self._row = row
        self._machine = machine
        self._known = {name: place for place, name in enumerate(machine.known(row.joints))}
        self._needed = frozenset(machine.needed(row.joints))
        self._required = tuple(rule.path for rule in row.fields if not rule.optional and "." not in rule.path)
        self._good: list[str] | None = None
        """Names that were found good: they seldom change."""

    def judge(self, seen: Observation) -> list[Finding]:
        """Names that are unknown, missing or there twice; arrays of a wrong length."""
        message = seen.message
        names = _names(message)
        found: list[Finding] = []
        if names != self._good:
            found += self._name_findings(names, message)
            self._good = None if found else names
        found += self._length_findings(message, len(names))
        if self._row.publisher in ("drive", "arm") and not found:
            found += self._command_findings(message, names)
        return found

    def _name_findings(self, names: list[str], message: Any) -> Iterator[Finding]:
        try:
            check_names(self._row.name, names, self._known)
        except RefusedMessageError as refusal:
            yield Finding.of_refusal(refusal)
        missing = sorted(self._needed.difference(names))
        if missing:
            yield Finding("name", f"without {', '.join(missing)}", "every one of these joints")
        if self._row.is_event and hasattr(message, "name") and not names:
            pose = message.header.frame_id
            if pose not in self._machine.poses:
                yield Finding("header.frame_id", repr(pose), "a joint, or a pose: " + ", ".join(self._machine.poses))

    def _length_findings(self, message: Any, count: int) -> Iterator[Finding]:
        if hasattr(message, "points"):
            try:
                check_message(self._row.name, trajectory_of(message))
            except RefusedMessageError as refusal:
                if "number" in str(refusal.value):
                    yield Finding.of_refusal(refusal)
            return
        for field in ("position", "velocity", "effort"):
            length = len(getattr(message, field))
            if length == count or (length == 0 and field not in self._required):
                continue
            none = "" if field in self._required else "none, or "
            yield Finding(field, f"{length} numbers", f"{none}one for each of {count} names")

    def _command_findings(self, message: Any, names: list[str]) -> Iterator[Finding]:
        """A joint held by position needs a position, one held by rate a rate."""
        held = self._machine.held
        for field, wanting in (("position", held), ("velocity", set(self._machine.motors) - held)):
            named = sorted(wanting.intersection(names))
            if named and not len(getattr(message, field)):
                yield Finding(field, "0 numbers", f"one for {', '.join(named)}")


class JointLimitRule:
    """Angles within the stops, and rates that the joint's drive can give. Degrees for radians show here.

    Args:
        row: a topic of joint states. machine: the rover.
    """

    name = "limit"

    def __init__(self, row: Topic, machine: JudgedMachine) -> None:
        self._joints = machine.joints
        self._names: list[str] = []
        self._limits: list[tuple[str, float, float, float]] = []

    def judge(self, seen: Observation) -> list[Finding]:
        """Angles and rates that the rover cannot have."""
        message = seen.message
        names = _names(message)
        if names != self._names:
            self._names, self._limits = names, [_limits(name, self._joints.get(name)) for name in names]
        found = []
        limits = self._limits
        for (name, low, high, _), angle in zip(limits, _numbers(message.position), strict=False):
            if not low <= angle <= high and angle == angle:
                allowed = f"{low:.4g} to {high:.4g} rad, the URDF's stops"
                found.append(Finding(f"position[{name}]", angle, allowed, max(low - angle, angle - high)))
        for (name, _, _, most), rate in zip(limits, _numbers(message.velocity), strict=False):
            if not -most <= rate <= most and rate == rate:
                allowed = f"{-most:.4g} to {most:.4g} rad/s, by the URDF's limit"
                found.append(Finding(f"velocity[{name}]", rate, allowed, abs(rate) - most))
        return found


def _names(message: Any) -> list[str]:
    return list(message.name if hasattr(message, "name") else message.joint_names)


def _limits(name: str, joint: UrdfJoint | None) -> tuple[str, float, float, float]:
    if joint is None:
        return name, -float("inf"), float("inf"), float("inf")
    return name, joint.lower - ANGLE_MARGIN, joint.upper + ANGLE_MARGIN, RATE_FACTOR * joint.velocity


def _numbers(values: Any) -> Iterable[float]:
    """Plain numbers of an array; far quicker to look at than an array's own elements."""
    numbers: Iterable[float] = values.tolist() if hasattr(values, "tolist") else values
    return numbers
