"""A fault of a sensor that comes during a run: all that may be wrong with one (`sensor_faults`), and when.

What changes a reading comes by the hooks of the sensors' node. What loses messages has to be known beforehand, as those
who wait for them have to: it comes at a time, and does not go.
"""

from collections.abc import Iterable
from typing import ClassVar, Self

from pydantic import Field, model_validator

from sojourn_machine.fault_choice import FaultableMachine, FaultChoice, FaultProblem, unknown
from sojourn_machine.sensor_faults import SensorFaultParams


class SensorFault(FaultChoice, SensorFaultParams):
    """Something is wrong with a sensor."""

    role: ClassVar[str] = "sensors"
    target: ClassVar[str] = "sensor"
    kind: str = "sensor"
    sensor: str = Field(min_length=1, description="name of the sensor")

    def as_params(self, after: float) -> SensorFaultParams:
        """As the sensor's table would have it, from a simulated time on [s]."""
        words = {key: getattr(self, key) for key in SensorFaultParams.model_fields}
        return SensorFaultParams.model_validate({**words, "after": after})

    def lost(self, seed: int) -> tuple[str, str, SensorFaultParams] | None:
        """See FaultChoice."""
        time = self.time(seed)
        return (self.sensor, self.called, self.as_params(time)) if self.loses and time is not None else None

    @property
    def in_scenario_alone(self) -> bool:
        """See FaultChoice."""
        return self.loses > 0.0

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        yield from unknown("sensor", self.sensor, machine.sensors, "is no sensor of the machine")
        if self.sensor in machine.sensors:
            yield from machine.sensors[self.sensor].fault_problems(self)

    @model_validator(mode="after")
    def _loses_from_a_time_on(self) -> Self:
        if self.after:
            raise ValueError(f"after = {self.after:g}: allowed is at, the time at which the fault comes")
        foreseen = self.when is None or self.when.between is not None
        if self.loses and not (foreseen and self.until is None and self.lasts is None):
            raise ValueError("messages are lost: allowed is a time at which that begins, and no end of it")
        return self
