"""Lidars: points where their beams meet the ground as it is now, rocks and the machine's own body, in the dark too.

One with several rows of beams says a cloud; one with a single row, a line scanner, a scan: distances from right to
left in the plane of its link's x and y.
"""

import math
from array import array
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sojourn_contract import stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.codecs.ros_library import stamped
from sojourn_contract.field_rules import FLOAT32_TOLERANCE
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.camera import noise_of
from sojourn_physics.imaging.ranging import LidarParams, beams_of, measured, strayed, within
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.fault_hooks import FaultNow
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

EVERY = 5
"""Control periods from scan to scan."""
RETURNED = FieldRule("intensity", "1", low=0.0, high=1.0)
CLOUD = Topic(
    "/{name}/points",
    "sensor_msgs/PointCloud2",
    "sensors",
    (),
    EVERY,
    0.5,
    "measured points that the beams of a lidar meet, in the frame of its link, and the part of light that comes back",
    (FieldRule("x y z", "m", low=-5000.0, high=5000.0), RETURNED),
)
_ANGLE = {"unit": "rad", "low": -math.pi, "high": math.pi, "tolerance": FLOAT32_TOLERANCE}
SCAN = Topic(
    "/{name}/scan",
    "sensor_msgs/LaserScan",
    "sensors",
    (),
    EVERY,
    0.5,
    "measured distances along the beams of a lidar with one row, in the plane of its link's x and y, and the part of "
    "light that comes back; no beams without power",
    (
        *(FieldRule(name, **_ANGLE) for name in ("angle_min", "angle_max", "angle_increment")),  # type: ignore[arg-type]
        FieldRule("ranges", "m", low=0.0, high=5000.0, tolerance=FLOAT32_TOLERANCE, infinite=True),
        FieldRule("intensities", "1", low=0.0, high=1.0, tolerance=FLOAT32_TOLERANCE),
    ),
)
NO_POINTS = np.zeros((0, 4), dtype=np.float32)


class LidarSensorParams(LidarParams, SeeingParams):
    """A lidar on its link."""

    kind: str = "lidar"
    speaks_on: ClassVar[tuple[Any, ...]] = (CLOUD, SCAN)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)
    has_lens: ClassVar[bool] = True

    @property
    def own_rows(self) -> tuple[Any, ...]:
        return (CLOUD,) if self.rows > 1 else (SCAN,)

    @property
    def every(self) -> int:
        """Control periods from scan to scan."""
        return EVERY if self.timing is None else self.timing.every or EVERY

    @property
    def bytes_a_second(self) -> float:
        numbers = NO_POINTS.shape[1] if self.rows > 1 else 2
        return 4.0 * numbers * self.rows * self.columns / (self.every * stamps.CONTROL_PERIOD_S)

    def sensor(self, name: str, site: SensorSite) -> "Lidar":
        """The lidar of a machine."""
        return Lidar(name, self, site) if self.rows > 1 else LineScanner(name, self, site)


class Lidar(SeeingSensor[LidarSensorParams, NDArray[Any]]):
    """Its reading are the points from which a beam comes back, (n, 4): x, y, z in the frame of the link [m], and the
    part of the light that the target returns; none without power.
    """

    every: ClassVar[int] = EVERY

    def __init__(self, name: str, params: LidarSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self.beams = beams_of(params)

    def read(self, ground: GroundMemory, truth: Truth) -> NDArray[Any]:
        read, returned = self.sounded(ground, truth)
        heard = np.isfinite(read)
        points = read[heard, np.newaxis] * self.beams.directions[heard]
        return np.column_stack([points, returned[heard]]).astype(np.float32)

    def sounded(self, ground: GroundMemory, truth: Truth) -> tuple[FloatArray, FloatArray]:
        """What is read of each beam [m], infinite where it is no distance, and what the target returns, each (n,)."""
        random, beams = noise_of(self.site.seed, self.name, truth.stamp), self.beams
        if self.params.pointing_noise_deg > 0.0:
            off = strayed(beams.directions, math.radians(self.params.pointing_noise_deg), random)
            beams = replace(beams, directions=off)
        here = self.outlook(truth)
        distance, returned = self.site.scene.scenery.sound(beams, ground, here.body, here.turn, here.place)
        return measured(self.params, distance, returned, random), returned

    def faulted(self, reading: NDArray[Any], fault: FaultNow) -> NDArray[Any]:
        """Dust on the window hides what is behind it; all other faults are on the points."""
        if fault.params.dust > 0.0:
            return reading[~fault.hidden(reading[:, :3].astype(float))]
        return np.column_stack([fault.on(reading[:, :3]), reading[:, 3]])

    def messages(self, stamp: int, reading: NDArray[Any] | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, point_cloud(stamp, self.params.link, NO_POINTS if reading is None else reading)


class LineScanner(Lidar):
    """Its reading are the distance along each beam [m] and the part of the light that comes back, (n, 2)."""

    def read(self, ground: GroundMemory, truth: Truth) -> NDArray[Any]:
        read, returned = self.sounded(ground, truth)
        return np.column_stack([read, np.where(np.isfinite(read), returned, 0.0)])

    def faulted(self, reading: NDArray[Any], fault: FaultNow) -> NDArray[Any]:
        """Dust on the window hides what is behind it; all other faults are on the distances."""
        if fault.params.dust > 0.0:
            hidden = fault.hidden(self.beams.directions)
            return np.where(hidden[:, np.newaxis], [math.inf, 0.0], reading)
        return np.column_stack([fault.on(reading[:, 0]), reading[:, 1]])

    def messages(self, stamp: int, reading: NDArray[Any] | None) -> Iterator[tuple[str, Any]]:
        params = self.params
        said = np.zeros((0, 2)) if reading is None else np.flipud(reading)
        azimuths = params.azimuths[::-1].tolist()
        scan = message_class(SCAN.type)(
            angle_min=azimuths[0],
            angle_max=azimuths[-1],
            angle_increment=(azimuths[-1] - azimuths[0]) / max(len(azimuths) - 1, 1),
            scan_time=params.every * stamps.CONTROL_PERIOD_S,
            range_min=params.nearest,
            range_max=params.range,
            ranges=_singles(within(params, said[:, 0])),
            intensities=_singles(said[:, 1]),
        )
        yield self.topic, stamped(scan, stamp, params.link)


def _singles(numbers: FloatArray) -> "array[float]":
    return array("f", numbers.astype(np.float32).tobytes())
