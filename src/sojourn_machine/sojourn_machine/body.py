"""A machine as its own computer knows it: its parts, and where its joints stand on it."""

from collections.abc import Mapping
from typing import NamedTuple

from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray


class JointPlace(NamedTuple):
    """A joint, seen from base_link with all joints at zero."""

    place: FloatArray
    """Its origin in base_link, shape (3,) [m]."""
    lower: float
    upper: float
    """Limits of its position, infinite where there are none [rad or m]."""
    velocity: float
    """Limit, infinite where there is none [rad/s or m/s]."""


class MachineBody(NamedTuple):
    """What a mobility is made for."""

    machine: MachineParams
    urdf_xml: str
    joints: Mapping[str, JointPlace]
    """Of all joints that move and that base_link carries, by name."""
    tracks: Mapping[str, FloatArray]
    """Middle of the flat run of each track in base_link, shape (3,) [m], by name."""
    gravity: float
    """[m/s^2]"""
    stowed: Mapping[str, float]
    """Joints of the arm while the machine drives, by name [rad]; none where there is no arm."""
