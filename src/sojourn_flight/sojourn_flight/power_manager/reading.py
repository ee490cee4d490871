"""Telemetry of one store."""

from dataclasses import dataclass

from sojourn_machine.errors import InvalidValueError

LARGEST = 1e6
"""Of volts, amperes and kelvins that any sensor of a store can mean; squares of what is far beyond are no numbers."""


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
            if not abs(value) <= LARGEST:
                raise InvalidValueError(f"{name} {quantity}", value, f"a number within {LARGEST:g}")
        if not 0.0 < self.temperature <= LARGEST:
            raise InvalidValueError(
                f"{name} temperature [K]", self.temperature, f"a number above 0, at most {LARGEST:g}"
            )
