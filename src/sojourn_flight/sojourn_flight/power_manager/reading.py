"""Telemetry of one store."""

from dataclasses import dataclass
from math import isfinite

from sojourn_machine.errors import InvalidValueError


@dataclass(frozen=True, slots=True)
class StoreReading:
    """Telemetry of one store."""

    voltage: float
    """Measured at its bus [V]."""
    current: float
    """Measured out of it [A]."""
    temperature: float
    """Measured [K]."""

    def require_numbers(self, name: str) -> None:
        """Raise InvalidValueError for what no sensor can mean; `name`: of the store."""
        for quantity, value in (("voltage [V]", self.voltage), ("current [A]", self.current)):
            if not isfinite(value):
                raise InvalidValueError(f"{name} {quantity}", value, "a finite number")
        if not isfinite(self.temperature) or self.temperature <= 0.0:
            raise InvalidValueError(f"{name} temperature [K]", self.temperature, "a finite number above 0")
