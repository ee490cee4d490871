"""The hazard camera: /hazcam/points, the ground in its view."""

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sojourn_contract.clouds import point_cloud
from sojourn_contract.topics import topic
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.sensors.noise import NoiseStream
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
    """Points in base_link, (n, 3) [m]; none without power."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: HazcamSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._camera = hazcam.hazcam_on(params, site.scenario.urdf_xml)
        self._ground = site.ground

    def initial_state(self, truth: Truth) -> NoiseStream:
        return hazcam.initial_state(self._camera, self.site.seed, self.name)

    def step(self, state: NoiseStream, truth: Truth, dt: float) -> tuple[NoiseStream, NDArray[np.float32]]:
        rotation = rotation_matrix(truth.odometry.orientation)
        return hazcam.step(self._camera, state, self._ground, truth.odometry.position, rotation)

    def messages(self, stamp: int, reading: NDArray[np.float32] | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, point_cloud(stamp, "base_link", NO_POINTS if reading is None else reading)
