"""Texts with a form: states of goals, switches, ticks, powers and energies."""

from math import isfinite
from typing import Any

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.conformance.ros_reading import diagnostics_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import status_values
from sojourn_contract.switches import check_switches
from sojourn_machine.status_keys import GOAL_STATES


class GoalStatusRule:
    """Status of drive or arm: state, goal_stamp and reason."""

    name = "status"

    def judge(self, seen: Observation) -> list[Finding]:
        """Values that are missing or have another form."""
        if not seen.message.status:
            return [Finding("status", "empty", "one status with state, goal_stamp and reason")]
        values = status_values(diagnostics_of(seen.message))
        found = []
        if values.get("state") not in GOAL_STATES:
            found.append(Finding("status.values.state", _shown(values, "state"), ", ".join(GOAL_STATES)))
        if not values.get("goal_stamp", "").isdecimal():
            found.append(Finding("status.values.goal_stamp", _shown(values, "goal_stamp"), "nanoseconds, whole"))
        if "reason" not in values:
            found.append(Finding("status.values.reason", "missing", "a reason in words; may be empty"))
        return found


class SwitchRule:
    """Switches of the loads."""

    name = "switches"

    def __init__(self, machine: JudgedMachine) -> None:
        self._loads = machine.loads

    def judge(self, seen: Observation) -> list[Finding]:
        """A load that the rover does not have, or a text that is no switch."""
        try:
            check_switches(seen.row.name, status_values(diagnostics_of(seen.message)), self._loads)
        except RefusedMessageError as refusal:
            return [Finding.of_refusal(refusal)]
        return []


class RequestRule:
    """Switches that an operator asks for: at least one, each on or off."""

    name = "request"

    def __init__(self, machine: JudgedMachine) -> None:
        self._loads = machine.loads

    def judge(self, seen: Observation) -> list[Finding]:
        """A load that the rover does not have, another text than on or off, or nothing at all."""
        if not seen.message.status or not seen.message.status[0].values:
            return [Finding("status.values", "empty", "loads with on or off")]
        values, known = status_values(diagnostics_of(seen.message)), (*self._loads, "sleep")
        allowed = "one of " + ", ".join(known)
        unknown = [Finding("status.values.key", name, allowed) for name in values if name not in known]
        return unknown + [
            Finding(f"status.values.{name}", text, "on or off")
            for name, text in values.items()
            if name in known and text not in ("on", "off")
        ]


class TickRule:
    """Ticks of the operator: the count of goals on each topic, which never falls."""

    name = "tick"

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}

    def judge(self, seen: Observation) -> list[Finding]:
        """A text of another form, or a count that falls."""
        try:
            counts, _ = parse_tick(seen.message.frame_id)
        except RefusedMessageError as refusal:
            return [Finding.of_refusal(refusal)]
        found = [
            Finding("frame_id", f"{name}={counts.get(name, 0)}", f"{count} or more, as said before")
            for name, count in self._counts.items()
            if counts.get(name, 0) < count
        ]
        self._counts = counts
        return found


class LoadRule:
    """Powers and energies of the plant's loads."""

    name = "loads"

    def judge(self, seen: Observation) -> list[Finding]:
        """Texts that are no finite number."""
        return [
            Finding(f"status.values.{key}", value, "a finite number")
            for key, value in status_values(diagnostics_of(seen.message)).items()
            if not _is_number(value)
        ]


def _is_number(text: str) -> bool:
    try:
        return isfinite(float(text))
    except ValueError:
        return False


def _shown(values: dict[str, Any], key: str) -> str:
    return repr(values[key]) if key in values else "missing"
