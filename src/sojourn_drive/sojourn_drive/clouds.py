"""Clouds of the hazard camera as the drive's input, and where the camera sits."""

from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.clouds import points_of
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.sensors.mounting import mounting

TOPIC = "/hazcam/points"


def eye_of(scenario: LoadedScenario) -> FloatArray | None:
    """Place of the rover's hazard camera in base_link, shape (3,) [m]; None for a rover without one."""
    camera = scenario.sensors.hazcam
    return None if camera is None else mounting(scenario.urdf_xml, camera.link)[1]


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
