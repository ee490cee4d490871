"""The Sun as the sensor on the machine sees it, and what the sensor makes of that as a message."""

import math

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.values import Vector3Stamped
from sojourn_machine.mounting import mounting
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import sun_sensor
from sojourn_sensors.motion import rotation_matrix


class SunReadings:
    """Readings of the sun sensor; of a machine without one they see no Sun. Its state is None where there is none."""

    def __init__(self, scenario: LoadedScenario) -> None:
        self._scenario = scenario
        self._params = scenario.sensors.sun
        self._frame = ""
        if self._params is not None:
            self._sensor_to_base, _ = mounting(scenario.urdf_xml, self._params.link)
            self._frame = self._params.link

    def initial_state(self) -> sun_sensor.SunSensorState | None:
        """Drawn by the scenario's seed."""
        if self._params is None:
            return None
        return sun_sensor.initial_state(self._params, self._scenario.config.seed)

    def reading(
        self, state: sun_sensor.SunSensorState | None, stamp: int, orientation: FloatArray
    ) -> tuple[sun_sensor.SunSensorState | None, FloatArray]:
        """Unit vector to the Sun at a stamp [ns], zeros for none, of a machine of a true attitude (x y z w)."""
        if self._params is None or state is None:
            return state, np.zeros(3)
        direction = self._scenario.sun_direction(stamps.seconds(stamp))
        in_sensor = (rotation_matrix(orientation) @ self._sensor_to_base).T @ direction
        in_sensor /= np.linalg.norm(in_sensor)  # the quaternion of a message is a unit one to rounding only
        elevation = math.asin(min(max(direction[2], -1.0), 1.0))
        return sun_sensor.step(self._params, state, in_sensor, elevation)

    def message(self, stamp: int, reading: FloatArray) -> Vector3Stamped:
        """/sun_direction."""
        return Vector3Stamped(stamp, self._frame, reading)
