"""Thermometers on parts of the machine: /temperature/NAME."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from sojourn_contract import stamps
from sojourn_contract.codecs.ros_library import stamped
from sojourn_contract.messages import ABSOLUTE_ZERO_C
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import NOT_MEASURED
from sojourn_machine.evolution import replace
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors import resistance_thermometer
from sojourn_physics.sensors.platinum_thermometer import PlatinumThermometerParams
from sojourn_physics.sensors.resistance_thermometer import (
    ResistanceThermometerParams,
    ThermometerReading,
    ThermometerState,
)
from sojourn_physics.sensors.thermistor import ThermistorParams
from sojourn_sensors.part_temperature import PartTemperature
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/temperature",
    "sensor_msgs/Temperature",
    "sensors",
    (),
    50,
    3.0,
    "measured temperature of a part of the machine, and the mean square of its error, 0 where a reading is at an end "
    "of its range; NaN while the sensor has no power",
    (
        FieldRule("temperature", "degree Celsius", low=ABSOLUTE_ZERO_C, high=1500.0, optional=True),
        FieldRule("variance", "K^2", low=0.0, high=1e6),
    ),
    all_named=True,
)


class OnPartParams(SensorParams, ResistanceThermometerParams):
    """A thermometer on one part of the machine."""

    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    node: str | None = Field(default=None, description="node of the machine's heat that it is on, of thermal.yaml")
    store: str | None = Field(default=None, description="energy store in whose cells it is")
    motor: str | None = Field(default=None, description="joint in whose motor's winding it is")

    @model_validator(mode="after")
    def _check_part(self) -> Self:
        if len(self.parts) != 1:
            given = " and ".join(part.key for part in self.parts) or "nothing"
            raise ValueError(f"{given} given: allowed is one of node, store, motor")
        return self

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        named = {"node": self.node, "store": self.store, "motor": self.motor}
        return tuple(MachinePart(kind, kind, (name,)) for kind, name in named.items() if name is not None)

    def sensor(self, name: str, site: SensorSite) -> "Thermometer":
        """The thermometer of a machine."""
        return Thermometer(name, self, site)


class PlatinumParams(OnPartParams, PlatinumThermometerParams):
    """A platinum thermometer on a part."""

    kind: str = "platinum_thermometer"


class ThermistorOnPartParams(OnPartParams, ThermistorParams):
    """A thermistor on a part."""

    kind: str = "thermistor"


@dataclass(frozen=True, slots=True)
class ThermometerMemory:
    """Of the thermometer, what was told last of its part [K], and when it was read last [ns]."""

    thermometer: ThermometerState | None
    """None until something has been told of its part."""
    known: float | None
    stamp: int


class Thermometer(Sensor[OnPartParams, ThermometerMemory, ThermometerReading]):
    """Says NaN without power; its element goes on following its part."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: OnPartParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        ((_, kind, (part,)),) = params.parts
        self._temperature = PartTemperature(site, kind, part)

    def initial_state(self, truth: Truth) -> ThermometerMemory:
        return self._after(ThermometerMemory(None, None, truth.stamp), truth)[0]

    def step(self, state: ThermometerMemory, truth: Truth, dt: float) -> tuple[ThermometerMemory, Any]:
        return self._after(state, truth)

    def step_without_power(self, state: ThermometerMemory, truth: Truth, dt: float) -> tuple[ThermometerMemory, None]:
        return self._after(state, truth)[0], None

    def hardware(self, state: ThermometerMemory) -> Any:
        """Temperature of its element [K]."""
        return None if state.thermometer is None else state.thermometer.element

    def with_hardware(self, state: ThermometerMemory, hardware: Any) -> ThermometerMemory:
        thermometer = resistance_thermometer.initial_state(self.params, self.site.seed, self.name, hardware)
        known = hardware if state.known is None else state.known
        return replace(state, thermometer=thermometer, known=known)

    def messages(self, stamp: int, reading: ThermometerReading | None) -> Iterator[tuple[str, Any]]:
        said = message_class(ROW.type)(temperature=NOT_MEASURED)
        if reading is not None:
            said.temperature, said.variance = reading.temperature + ABSOLUTE_ZERO_C, reading.variance
        yield self.topic, stamped(said, stamp, "base_link")

    def _after(self, state: ThermometerMemory, truth: Truth) -> tuple[ThermometerMemory, ThermometerReading | None]:
        told = self._temperature.told(truth)
        known = state.known if told is None else told
        if known is None:
            return ThermometerMemory(None, None, truth.stamp), None
        before = state.thermometer
        if before is None:
            before = resistance_thermometer.initial_state(self.params, self.site.seed, self.name, known)
        dt = max(truth.stamp - state.stamp, 0) / stamps.NANOSECONDS
        after, reading = resistance_thermometer.step(self.params, before, known, dt)
        return ThermometerMemory(after, known, truth.stamp), reading
