"""How warm a part of the machine is, as the plant tells it: a node of its heat, a store, the winding of a motor."""

from sojourn_contract.heartbeat import status_values
from sojourn_contract.messages import battery_readings
from sojourn_contract.run_table import STORE, things_of
from sojourn_machine.errors import InvalidValueError
from sojourn_sensors.sensor import SensorSite, Truth

LOADS, STORES = "/truth/loads", "/truth/electrical"
KEYS = {"node": "temperature", "motor": "winding"}
"""First words of the keys under which /truth/loads has the temperatures of parts, by their kind."""


class PartTemperature:
    """Of one part.

    Args:
        site: of the sensor. kind, part: as `SensorParams.parts` has them.
    """

    def __init__(self, site: SensorSite, kind: str, part: str) -> None:
        self._topic, self._key = LOADS, ""
        if kind == STORE:
            self._topic = site.table.each(STORES)[things_of(site.scenario)[STORE].index(part)].name
        else:
            self._key = f"{KEYS[kind]} {part}"

    def told(self, truth: Truth) -> float | None:
        """It [K]; None where nothing new is said of it. Raises InvalidValueError."""
        message = truth.inputs.get(self._topic)
        if message is None:
            return None
        if not self._key:
            return battery_readings(message)[2]
        text = status_values(message).get(self._key)
        if text is None:
            return None
        try:
            return float(text)
        except ValueError:
            raise InvalidValueError(f"{self._topic} {self._key}", text, "a number") from None
