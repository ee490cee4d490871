"""The machine as its own computer knows it, from its files: where its joints and tracks stand on base_link."""

from collections.abc import Mapping

from sojourn_config.machine import MachineConfig
from sojourn_config.mechanism_checks import BASE_LINK
from sojourn_config.urdf import UrdfSummary
from sojourn_machine.body import BodyLayout, JointPlace, MachineBody

STOWED = "stow"
"""Pose of the arm while the machine drives."""


def machine_body(config: MachineConfig, urdf: UrdfSummary, gravity: float, stowed: Mapping[str, float]) -> MachineBody:
    """The body of a machine whose files have been checked. gravity: [m/s^2]. stowed: joints of its arm [rad]."""
    return MachineBody(body_layout(config, urdf), urdf.text, gravity, stowed)


def body_layout(config: MachineConfig, urdf: UrdfSummary) -> BodyLayout:
    """Where the parts of a machine are, all joints at zero."""
    carried = set(urdf.below(BASE_LINK))
    joints = {
        name: JointPlace(urdf.position_in_link(name, BASE_LINK), joint.lower, joint.upper, joint.velocity)
        for name, joint in urdf.joints.items()
        if name in urdf.moving_joints and joint.parent in carried
    }
    tracks = {track.name: urdf.point_in_link(track.link, track.position, BASE_LINK) for track in config.tracks}
    return BodyLayout(config, joints, tracks)
