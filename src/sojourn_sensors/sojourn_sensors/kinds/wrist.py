"""The force/torque sensor of the arm's wrist: /wrist/wrench."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field

from sojourn_contract.messages import wrench_of, wrench_stamped
from sojourn_contract.topics import topic
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors import wrench
from sojourn_physics.sensors.wrench import WrenchSensorParams, WrenchSensorState
from sojourn_physics.sensors.wrench_errors import WrenchConditions
from sojourn_sensors.part_temperature import PartTemperature
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

TOPIC = "/wrist/wrench"


class WristSensorParams(WrenchSensorParams, SensorParams):
    """The sensor at `wrench_sensor_link` of the machine or its arm."""

    kind: str = "wrist"
    speaks_on: ClassVar[tuple[Any, ...]] = (topic(TOPIC),)
    left_out: ClassVar[tuple[str, ...]] = ("errors", "node")
    node: str | None = Field(
        default=None, description="node of the machine's heat that it is as warm as; none: it does not drift with it"
    )

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        return () if self.node is None else (MachinePart("node", "node", (self.node,)),)

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        yield TOPIC, wrench_stamped(stamp, "", None)

    def sensor(self, name: str, site: SensorSite) -> "WristSensor":
        """The sensor of a machine's wrist."""
        return WristSensor(name, self, site)


@dataclass(frozen=True, slots=True)
class WristMemory:
    """Of the sensor, and how warm it was when that was last told [K]."""

    wrench: WrenchSensorState
    temperature: float | None = None


class WristSensor(Sensor[WristSensorParams, WristMemory, FloatArray | None]):
    """Force and moment, (6,); none where nobody tells the truth of it."""

    def __init__(self, name: str, params: WristSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._frame = site.scenario.machine.wrench_sensor_link or ""
        self._warmth = None if params.node is None else PartTemperature(site, "node", params.node)

    def initial_state(self, truth: Truth) -> WristMemory:
        return WristMemory(wrench.initial_state(self.params, self.site.seed, self.name))

    def step(self, state: WristMemory, truth: Truth, dt: float) -> tuple[WristMemory, FloatArray | None]:
        told = None if self._warmth is None else self._warmth.told(truth)
        temperature = state.temperature if told is None else told
        message = truth.inputs.get("/truth/wrist_wrench")
        true = None if message is None else wrench_of(message)
        if true is None:
            return WristMemory(state.wrench, temperature), None
        after, reading = wrench.step(state.wrench, true, WrenchConditions(dt, temperature))
        return WristMemory(after, temperature), reading

    def step_without_power(self, state: WristMemory, truth: Truth, dt: float) -> tuple[WristMemory, None]:
        return self.step(state, truth, dt)[0], None

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, wrench_stamped(stamp, self._frame, reading)
