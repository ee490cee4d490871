"""Lidars: points where their beams meet the ground as it is now, rocks and the machine's own body, in the dark too."""

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sojourn_contract import stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_physics.imaging.camera import noise_of
from sojourn_physics.imaging.ranging import LidarParams, beams_of, measured
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.fault_hooks import FaultNow
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

EVERY = 5
"""Control periods from scan to scan."""
CLOUD = Topic(
    "/{name}/points",
    "sensor_msgs/PointCloud2",
    "sensors",
    (),
    EVERY,
    0.5,
    "measured points that the beams of a lidar meet, in the frame of its link, and the part of light that comes back",
    (FieldRule("x y z", "m", low=-5000.0, high=5000.0), FieldRule("intensity", "1", low=0.0, high=1.0)),
)
NO_POINTS = np.zeros((0, 4), dtype=np.float32)


class LidarSensorParams(LidarParams, SeeingParams):
    """A lidar on its link."""

    kind: str = "lidar"
    speaks_on: ClassVar[tuple[Any, ...]] = (CLOUD,)

    @property
    def bytes_a_second(self) -> float:
        every = EVERY if self.timing is None else self.timing.every or EVERY
        return 4.0 * NO_POINTS.shape[1] * self.rows * self.columns / (every * stamps.CONTROL_PERIOD_S)

    def sensor(self, name: str, site: SensorSite) -> "Lidar":
        """The lidar of a machine."""
        return Lidar(name, self, site)


class Lidar(SeeingSensor[LidarSensorParams, NDArray[np.float32]]):
    """Its reading are the points from which a beam comes back, (n, 4): x, y, z in the frame of the link [m], and the
    part of the light that the target returns; none without power.
    """

    every: ClassVar[int] = EVERY

    def __init__(self, name: str, params: LidarSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self.beams = beams_of(params)

    def read(self, ground: GroundMemory, truth: Truth) -> NDArray[np.float32]:
        here = self.outlook(truth)
        distance, returned = self.site.scene.scenery.sound(self.beams, ground, here.body, here.turn, here.place)
        read = measured(self.params, distance, returned, noise_of(self.site.seed, self.name, truth.stamp))
        heard = np.isfinite(read)
        points = read[heard, np.newaxis] * self.beams.directions[heard]
        return np.column_stack([points, returned[heard]]).astype(np.float32)

    def faulted(self, reading: NDArray[np.float32], fault: FaultNow) -> NDArray[np.float32]:
        """Dust on the window hides what is behind it; all other faults are on the points."""
        if fault.params.dust > 0.0:
            return reading[~fault.hidden(reading[:, :3].astype(float))]
        return np.column_stack([fault.on(reading[:, :3]), reading[:, 3]])

    def messages(self, stamp: int, reading: NDArray[np.float32] | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, point_cloud(stamp, self.params.link, NO_POINTS if reading is None else reading)
