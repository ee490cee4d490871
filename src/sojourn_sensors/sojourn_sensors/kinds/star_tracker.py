"""Star trackers: /attitude/NAME."""

import math
from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin

from sojourn_contract import stamps
from sojourn_contract.codecs.ros_library import stamped
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import NOT_MEASURED
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import star_tracker
from sojourn_physics.sensors.star_tracker import THIN_AIR, StarTrackerParams, StarTrackerState, StarTrackerView
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/attitude",
    "geometry_msgs/QuaternionStamped",
    "sensors",
    (),
    10,
    1.0,
    "measured attitude of its link in map, by the stars; NaN where it finds none and without power",
    (FieldRule("quaternion", "1", frame="map", low=-1.0, high=1.0, optional=True),),
    all_named=True,
)


class StarTrackerKindParams(SensorParams, StarTrackerParams):
    """A star tracker on its link."""

    kind: str = "star_tracker"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)

    def sensor(self, name: str, site: SensorSite) -> "StarTracker":
        """The star tracker of a machine."""
        return StarTracker(name, self, site)


class StarTracker(Sensor[StarTrackerKindParams, StarTrackerState, FloatArray | None]):
    """Sees the sky of the scenario over its ground, and the scenario's Sun."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: StarTrackerKindParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._link_to_base, _ = site.mounting(params.link)
        self._sun = site.scenario.sun_over(lambda: site.ground)
        body = site.scenario.body
        self._in_orbit = body.free_fall
        self._air = body.atmosphere is not None and body.air_at(site.scenario.site).density > THIN_AIR

    def initial_state(self, truth: Truth) -> StarTrackerState:
        return star_tracker.initial_state(self.params, self.site.seed, self.name)

    def step(self, state: StarTrackerState, truth: Truth, dt: float) -> tuple[StarTrackerState, FloatArray | None]:
        return star_tracker.step(self.params, state, self._view(truth))

    def step_without_power(self, state: StarTrackerState, truth: Truth, dt: float) -> tuple[StarTrackerState, None]:
        return self.step(state, truth, dt)[0], None

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        said = message_class(ROW.type)()
        values = (NOT_MEASURED,) * 4 if reading is None else reading.tolist()
        said.quaternion.x, said.quaternion.y, said.quaternion.z, said.quaternion.w = values
        yield self.topic, stamped(said, stamp, "map")

    def _view(self, truth: Truth) -> StarTrackerView:
        odometry = truth.odometry
        x, y, _ = odometry.position.tolist()
        rotation = rotation_matrix(odometry.orientation) @ self._link_to_base
        orientation = np.array(pin.Quaternion(quaternion_of(rotation)).normalized().coeffs())
        light = self._sun.light(stamps.seconds(truth.stamp), x, y)
        horizon = -math.inf
        if not self._in_orbit:
            azimuth = np.array((math.atan2(rotation[0, 2], rotation[1, 2]),))
            horizon = float(self._sun.horizon(x, y, azimuth)[0])
        rate = math.sqrt(float(odometry.angular @ odometry.angular))
        return StarTrackerView(orientation, rate, light.direction, light.visible, horizon, self._air)
