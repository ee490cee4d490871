"""How warm a sensor is: a node of the machine's heat, by the load of the sensor."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.heartbeat import status_values
from sojourn_sensors.supply import LOADS


class LoadTemperature:
    """Temperature of what a sensor's load warms, which the plant tells now and then.

    Args:
        name: of the sensor. scenario: with the machine. otherwise: where no thermal.yaml tells it [K].
    """

    def __init__(self, name: str, scenario: LoadedScenario, otherwise: float) -> None:
        thermal = scenario.thermal
        node = None if thermal is None else thermal.warms.get(scenario.sensors.powered_by.get(name, ""))
        self._key = "" if node is None else f"temperature {node}"
        self.at_first = otherwise if node is None or thermal is None else thermal.nodes[node].temperature
        """[K]."""

    def told(self, inputs: Mapping[str, Any], before: float) -> float:
        """By a period's truth, `before` where it tells nothing [K]."""
        loads = inputs.get(LOADS) if self._key else None
        if loads is None:
            return before
        try:
            told = float(status_values(loads).get(self._key, before))
        except ValueError:
            return before
        return told if isfinite(told) else before
