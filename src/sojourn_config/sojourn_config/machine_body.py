"""The machine as its own computer knows it, from its files: where its joints and tracks stand on base_link."""

from collections.abc import Mapping

from sojourn_config.machine import MachineConfig
from sojourn_config.mechanism_checks import BASE_LINK
from sojourn_config.urdf import UrdfSummary
from sojourn_machine.body import JointPlace, MachineBody

STOWED = "stow"
"""Pose of the arm while the machine drives."""


def machine_body(config: MachineConfig, urdf: UrdfSummary, gravity: float, stowed: Mapping[str, float]) -> MachineBody:
    """The body of a machine whose files have been checked. gravity: [m/s^2]. stowed: joints of its arm [rad]."""
    tracks = {track.name: urdf.point_in_link(track.link, track.position, BASE_LINK) for track in config.tracks}
    return MachineBody(config, urdf.text, joint_places(urdf), tracks, gravity, stowed)


def joint_places(urdf: UrdfSummary) -> dict[str, JointPlace]:
    """The joints that move and that base_link carries."""
    carried = set(urdf.below(BASE_LINK))
    return {
        name: JointPlace(urdf.position_in_link(name, BASE_LINK), joint.lower, joint.upper, joint.velocity)
        for name, joint in urdf.joints.items()
        if name in urdf.moving_joints and joint.parent in carried
    }
