"""The hazard camera as a node knows it: where it sits, and which of its clouds are new."""

import numpy as np

from sojourn_config.known_machine import KnownMachine
from sojourn_contract.values import PointCloud2
from sojourn_flight.hazards.own_body import OwnBody
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_machine.mounting import mounting
from sojourn_physics.sensors.hazcam import HazcamParams

TOPIC = "/hazcam/points"


def hazard_camera_of(scenario: KnownMachine) -> StereoCamera | None:
    """The rover's hazard camera; None for a rover without one."""
    camera = scenario.sensors.first(HazcamParams)
    if camera is None:
        return None
    rotation, position = mounting(scenario.urdf_xml, camera.link)
    noise = camera.disparity_noise_px / (camera.focal_length_px * camera.baseline)
    return StereoCamera(position, np.ascontiguousarray(rotation[:, 0]), noise)


def own_body_of(scenario: KnownMachine) -> OwnBody | None:
    """The machine's body, where it is in the view of its hazard camera."""
    camera = scenario.sensors.first(HazcamParams)
    return OwnBody(scenario.urdf_xml) if camera is not None and camera.sees_body else None


def newest_cloud(message: PointCloud2 | None, last: int) -> int:
    """Stamp of a cloud [ns]: `last`, that of the one before (-1 before the first), where it is no new one. In real time
    the latest is an input of every period.
    """
    return last if message is None else message.stamp
