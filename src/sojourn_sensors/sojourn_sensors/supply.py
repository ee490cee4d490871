"""Which sensors have power: those whose load draws some, by what the plant says of its loads."""

from collections.abc import Mapping
from typing import Any

from sojourn_contract.heartbeat import status_values

LOADS = "/truth/loads"
POWER = "power "
"""Begins the key of a load's power."""


def without_power(powered_by: Mapping[Any, str], before: frozenset[str], loads: Any) -> frozenset[str]:
    """Sensors whose load draws nothing, by a message on /truth/loads; None, or a load that it does not name, leaves
    what was known.

    Args:
        powered_by: load of each sensor by the sensor's name; one that is not in it always has power.
        before: those that were without power so far.
    """
    if loads is None:
        return before
    powers = status_values(loads)
    drawn = {str(sensor): powers.get(POWER + load) for sensor, load in powered_by.items()}
    reported = {sensor for sensor, power in drawn.items() if power is not None}
    return frozenset((before - reported) | {sensor for sensor in reported if not _is_positive(drawn[sensor])})


def _is_positive(text: str | None) -> bool:
    try:
        return text is not None and float(text) > 0.0
    except ValueError:
        return False
