"""Magnetometers: /magnetic_field/NAME."""

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np

from sojourn_contract.codecs.ros_library import stamped
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import NOT_MEASURED
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import magnetometer
from sojourn_physics.sensors.magnetometer import MagnetometerParams, MagnetometerState
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/magnetic_field",
    "sensor_msgs/MagneticField",
    "sensors",
    (),
    5,
    0.5,
    "measured magnetic flux density in the axes of its link, with the variance of such an instrument; NaN without "
    "power",
    (FieldRule("magnetic_field", "T", low=-10.0, high=10.0, optional=True),),
    all_named=True,
)
NOTHING = np.full(3, NOT_MEASURED)


class MagnetometerSensorParams(SensorParams, MagnetometerParams):
    """A magnetometer on its link. On a body of which no field is known it reads its own errors."""

    kind: str = "magnetometer"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)

    @property
    def needs_magnetic_site(self) -> bool:
        return True

    def sensor(self, name: str, site: SensorSite) -> "Magnetometer":
        """The magnetometer of a machine."""
        return Magnetometer(name, self, site)


class Magnetometer(Sensor[MagnetometerSensorParams, MagnetometerState, FloatArray]):
    """It reads the field of the site: over a machine's way that is the same everywhere."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: MagnetometerSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._to_base, _ = site.mounting(params.link)
        self._field = site.scenario.body.magnetic_field_over(site.scenario.site)

    def initial_state(self, truth: Truth) -> MagnetometerState:
        return magnetometer.initial_state(self.params, self.site.seed, self.name)

    def step(self, state: MagnetometerState, truth: Truth, dt: float) -> tuple[MagnetometerState, FloatArray]:
        turn = rotation_matrix(truth.odometry.orientation) @ self._to_base
        return magnetometer.step(self.params, state, turn.T @ self._field)

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        field = NOTHING if reading is None else reading
        variance = 0.0 if reading is None else magnetometer.deviation(self.params, reading) ** 2
        said = message_class(ROW.type)(magnetic_field_covariance=(variance * np.eye(3)).ravel())
        vector = said.magnetic_field
        vector.x, vector.y, vector.z = field.tolist()
        yield self.topic, stamped(said, stamp, self.params.link)
