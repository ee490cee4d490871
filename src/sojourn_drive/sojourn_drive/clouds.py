"""Clouds of the hazard camera as the drive's input, and where the camera sits."""

from typing import Any

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.clouds import points_of
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.sensors.mounting import mounting
from sojourn_mechanics.steering.stereo_eye import StereoEye

TOPIC = "/hazcam/points"


def eye_of(scenario: LoadedScenario) -> StereoEye | None:
    """The rover's hazard camera; None for a rover without one."""
    camera = scenario.sensors.hazcam
    if camera is None:
        return None
    rotation, position = mounting(scenario.urdf_xml, camera.link)
    noise = camera.disparity_noise_px / (camera.focal_length_px * camera.baseline)
    return StereoEye(position, np.ascontiguousarray(rotation[:, 0]), noise)


class Clouds:
    """Takes each cloud once: in real time the latest is an input of every period."""

    def __init__(self) -> None:
        self._last = -1

    def points(self, message: Any) -> FloatArray | None:
        """Points in base_link, shape (n, 3) [m], of a cloud that is new; else None."""
        if message is None:
            return None
        stamp = stamps.from_message(message.header.stamp)
        if stamp == self._last:
            return None
        self._last = stamp
        return points_of(TOPIC, message)
