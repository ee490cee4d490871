"""The Sun as the sensor on the machine sees it, and what the sensor makes of that as a message."""

import math
from typing import Any

import numpy as np
from geometry_msgs.msg import Vector3Stamped

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.messages import quaternion, set_xyz
from sojourn_mechanics.sensors import sun_sensor
from sojourn_mechanics.sensors.mounting import mounting
from sojourn_sensors.motion import rotation_matrix


class SunReadings:
    """Readings of the sun sensor; of a machine without one they see no Sun."""

    def __init__(self, scenario: LoadedScenario) -> None:
        self._scenario = scenario
        self._params = scenario.sensors.sun
        self._message = Vector3Stamped()
        if self._params is not None:
            self._sensor_to_base, _ = mounting(scenario.urdf_xml, self._params.link)
            self._state = sun_sensor.initial_state(self._params, scenario.config.seed)
            self._message.header.frame_id = self._params.link

    def message(self, stamp: int, odometry: Any) -> Vector3Stamped:
        """The reading at a stamp [ns] of a machine whose true attitude is in `odometry`."""
        reading = np.zeros(3)
        if self._params is not None:
            direction = self._scenario.sun_direction(stamps.seconds(stamp))
            sensor_to_map = rotation_matrix(quaternion(odometry.pose.pose.orientation)) @ self._sensor_to_base
            in_sensor = sensor_to_map.T @ direction
            in_sensor /= np.linalg.norm(in_sensor)  # the quaternion of a message is a unit one to rounding only
            elevation = math.asin(min(max(direction[2], -1.0), 1.0))
            self._state, reading = sun_sensor.step(self._params, self._state, in_sensor, elevation)
        self._message.header.stamp = stamps.to_message(stamp)
        set_xyz(self._message.vector, reading)
        return self._message
