"""What the hazard camera sees from the true pose of the base."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.messages import quaternion, xyz
from sojourn_mechanics.sensors import hazcam
from sojourn_sensors.motion import rotation_matrix


class HazardView:
    """The hazard camera of a scenario's rover before the scenario's ground; of a rover without one, nothing.

    Args:
        scenario: its ground is made only where there is a camera. Raises ConfigError if it cannot be made.
    """

    def __init__(self, scenario: LoadedScenario) -> None:
        params = scenario.sensors.hazcam
        self._camera = None if params is None else hazcam.hazcam_on(params, scenario.urdf_xml)
        if self._camera is not None:
            self._ground = scenario.height_field()
            self._state = hazcam.initial_state(self._camera, scenario.config.seed)
            hazcam.step(self._camera, self._state, self._ground, np.zeros(3), np.eye(3))  # the compiler is through

    def look(self, odometry: Any) -> NDArray[np.float32]:
        """Points in base_link, shape (n, 3) [m], from the base's true odometry."""
        if self._camera is None:
            return np.zeros((0, 3), dtype=np.float32)
        pose = odometry.pose.pose
        turned = rotation_matrix(quaternion(pose.orientation))
        self._state, points = hazcam.step(self._camera, self._state, self._ground, xyz(pose.position), turned)
        return points
