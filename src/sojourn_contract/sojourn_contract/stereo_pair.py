"""The stereo pair whose images the drive goes by, as a node knows it: its topics, and where it sits.

A run of a machine whose drive has `visual_odometry` has the drive among the subscribers of the pair's rows; nobody has
to hear them, so that a drive of another make may go by something else.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from sojourn_config.known_machine import KnownMachine
from sojourn_contract.topic_types import Topic
from sojourn_flight.odometry.stereo_geometry import CameraPlace
from sojourn_machine.mounting import mounting
from sojourn_physics.imaging.camera import LINK_TO_OPTICAL


class PairTopics(NamedTuple):
    """On which a pair speaks that makes rectified stereo possible."""

    left: str
    left_info: str
    right: str
    right_info: str


def pair_topics(name: str) -> PairTopics:
    """Of the pair of a name."""
    return PairTopics(*(f"/{name}/{side}/{what}" for side in ("left", "right") for what in ("image", "camera_info")))


def pair_in_use(scenario: KnownMachine) -> PairTopics | None:
    """Topics that the drive goes by; None of one that goes by none."""
    drive = scenario.driving
    return None if drive is None or drive.visual_odometry is None else pair_topics(drive.visual_odometry.camera)


def pair_place_of(scenario: KnownMachine) -> CameraPlace | None:
    """Where it sits; None where the drive goes by none."""
    drive = scenario.driving
    if drive is None or drive.visual_odometry is None:
        return None
    link = scenario.sensors.sensors[drive.visual_odometry.camera].links[0]
    rotation, position = mounting(scenario.urdf_xml, link)
    return CameraPlace(rotation @ LINK_TO_OPTICAL, position)


def heard_by_drive(scenario: KnownMachine, rows: Iterable[Topic]) -> Iterator[Topic]:
    """The rows, those of the pair that the drive goes by with the drive among their subscribers."""
    names = pair_in_use(scenario) or ()
    for row in rows:
        if row.name in names:
            yield replace(row, subscribers=(*row.subscribers, "drive"), needs_listener=False)
        else:
            yield row
