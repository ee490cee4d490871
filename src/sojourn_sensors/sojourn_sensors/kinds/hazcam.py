"""The hazard camera: /hazcam/points, the ground in its view."""

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sojourn_contract import stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.topics import topic
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.sensors.noise import NoiseStream
from sojourn_sensors.fault_hooks import FaultNow
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = topic("/hazcam/points")
NO_POINTS = np.zeros((0, 3), dtype=np.float32)


class HazcamSensorParams(HazcamParams, SensorParams):
    """A stereo camera on its link."""

    kind: str = "hazcam"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        yield ROW.name, point_cloud(stamp, "base_link", NO_POINTS)

    def sensor(self, name: str, site: SensorSite) -> "HazcamSensor":
        """The camera of a machine."""
        return HazcamSensor(name, self, site)


class HazcamSensor(Sensor[HazcamSensorParams, NoiseStream, NDArray[np.float32]]):
    """Points in base_link, (n, 3) [m]; none without power, nor in the dark where it has no lamp."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: HazcamSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._camera = hazcam.hazcam_on(params, site.scenario.urdf_xml)
        self._lens_to_base, self._place = site.mounting(params.link)
        self._ground = site.ground
        self._sun = site.scenario.sun_over(lambda: site.ground)

    def initial_state(self, truth: Truth) -> NoiseStream:
        return hazcam.initial_state(self._camera, self.site.seed, self.name)

    def step(self, state: NoiseStream, truth: Truth, dt: float) -> tuple[NoiseStream, NDArray[np.float32]]:
        rotation = rotation_matrix(truth.odometry.orientation)
        after, points = hazcam.step(self._camera, state, self._ground, truth.odometry.position, rotation)
        return after, NO_POINTS if self._is_dark(truth) else points

    def _is_dark(self, truth: Truth) -> bool:
        if self.params.least_light == 0.0:
            return False
        x, y, _ = truth.odometry.position
        light = self._sun.light(stamps.seconds(truth.stamp), float(x), float(y))
        return light.direct + light.diffuse < self.params.least_light

    def faulted(self, reading: NDArray[np.float32], fault: FaultNow) -> NDArray[np.float32]:
        """Dust on the lens hides what is behind it; all other faults are on the points."""
        if fault.params.dust == 0.0:
            return super().faulted(reading, fault)
        return reading[~fault.hidden((reading - self._place) @ self._lens_to_base)]

    def messages(self, stamp: int, reading: NDArray[np.float32] | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, point_cloud(stamp, "base_link", NO_POINTS if reading is None else reading)
