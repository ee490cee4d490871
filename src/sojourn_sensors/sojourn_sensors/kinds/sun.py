"""The Sun sensor: /sun_direction."""

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.topics import topic
from sojourn_contract.values import Vector3Stamped
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import sun_sensor
from sojourn_physics.sensors.sun_sensor import SunSensorParams, SunSensorState
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = topic("/sun_direction")
NO_SUN = np.zeros(3)
NO_SUN.flags.writeable = False


class SunSensorKindParams(SunSensorParams, SensorParams):
    """A Sun sensor on its link."""

    kind: str = "sun"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        yield ROW.name, Vector3Stamped(stamp, "", NO_SUN)

    def sensor(self, name: str, site: SensorSite) -> "SunSensor":
        """The Sun sensor of a machine."""
        return SunSensor(name, self, site)


class SunSensor(Sensor[SunSensorKindParams, SunSensorState, FloatArray]):
    """Sees the scenario's Sun, which moves as the body turns: a unit vector in the link's frame, zeros for none.

    It is dark where less than half of the disc is seen: by night, in the shadow of the ground, in an eclipse.
    """

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: SunSensorKindParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._sensor_to_base, _ = site.mounting(params.link)
        self._sun = site.scenario.sun_over(lambda: site.ground)

    def initial_state(self, truth: Truth) -> SunSensorState:
        return sun_sensor.initial_state(self.params, self.site.seed, self.name)

    def step(self, state: SunSensorState, truth: Truth, dt: float) -> tuple[SunSensorState, FloatArray]:
        x, y, _ = truth.odometry.position
        light = self._sun.light(stamps.seconds(truth.stamp), float(x), float(y))
        in_sensor = (rotation_matrix(truth.odometry.orientation) @ self._sensor_to_base).T @ light.direction
        in_sensor /= np.linalg.norm(in_sensor)  # the quaternion of a message is a unit one to rounding only
        return sun_sensor.step(self.params, state, in_sensor, light.visible)

    def step_without_power(self, state: SunSensorState, truth: Truth, dt: float) -> tuple[SunSensorState, FloatArray]:
        return self.step(state, truth, dt)[0], NO_SUN

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, Vector3Stamped(stamp, self.params.link, NO_SUN if reading is None else reading)
