"""An inclinometer: how far its link leans about x and y [rad], as the third component nothing."""

from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import Vector3Stamped
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors.noise import draw, initial_stream
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor

LEAN = FieldRule("vector", "rad", low=-1.6, high=1.6)
ROW = Topic("/inclinometer", "geometry_msgs/Vector3Stamped", "sensors", (), 10, 0.5, "how far the deck leans", (LEAN,))


class InclinometerParams(SensorParams):
    kind: str = "inclinometer"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    link: str = Field(description="link that carries it")
    noise: float = Field(ge=0.0, le=0.1, description="standard deviation [rad]")

    def sensor(self, name, site):
        return Inclinometer(name, self, site)


class Inclinometer(Sensor[InclinometerParams, Any, Any]):
    every = ROW.every

    def __init__(self, name, params, site):
        super().__init__(name, params, site)
        self._to_base, _ = site.mounting(params.link)

    def initial_state(self, truth):
        return initial_stream(self.site.seed, self.name, 2)

    def step(self, state, truth, dt):
        state, noise = draw(state)
        up = (rotation_matrix(truth.odometry.orientation) @ self._to_base)[2]
        return state, np.array([np.arctan2(up[1], up[2]), np.arcsin(np.clip(-up[0], -1.0, 1.0)), 0.0]) + np.append(
            self.params.noise * noise, 0.0
        )

    def messages(self, stamp, reading):
        yield self.topic, Vector3Stamped(stamp, self.params.link, reading)
