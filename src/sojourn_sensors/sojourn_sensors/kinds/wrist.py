"""The force/torque sensor of the arm's wrist: /wrist/wrench."""

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

from sojourn_contract.messages import wrench_of, wrench_stamped
from sojourn_contract.topics import topic
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import wrench
from sojourn_physics.sensors.wrench import WrenchSensorParams, WrenchSensorState
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

TOPIC = "/wrist/wrench"


class WristSensorParams(WrenchSensorParams, SensorParams):
    """The sensor at `wrench_sensor_link` of the machine or its arm."""

    kind: str = "wrist"
    speaks_on: ClassVar[tuple[Any, ...]] = (topic(TOPIC),)

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        yield TOPIC, wrench_stamped(stamp, "", None)

    def sensor(self, name: str, site: SensorSite) -> "WristSensor":
        """The sensor of a machine's wrist."""
        return WristSensor(name, self, site)


class WristSensor(Sensor[WristSensorParams, WrenchSensorState, FloatArray | None]):
    """Force and moment, (6,); none where nobody tells the truth of it."""

    def __init__(self, name: str, params: WristSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._frame = site.scenario.machine.wrench_sensor_link or ""

    def initial_state(self, truth: Truth) -> WrenchSensorState:
        return wrench.initial_state(self.params, self.site.seed, self.name)

    def step(self, state: WrenchSensorState, truth: Truth, dt: float) -> tuple[WrenchSensorState, FloatArray | None]:
        message = truth.inputs.get("/truth/wrist_wrench")
        true = None if message is None else wrench_of(message)
        return (state, None) if true is None else wrench.step(state, true)

    def step_without_power(self, state: WrenchSensorState, truth: Truth, dt: float) -> tuple[WrenchSensorState, None]:
        return self.step(state, truth, dt)[0], None

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, wrench_stamped(stamp, self._frame, reading)
