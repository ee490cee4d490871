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


class BodyLayout(NamedTuple):
    """Where the parts of a machine are."""

    machine: MachineParams
    joints: Mapping[str, JointPlace]
    """Of all joints that move and that base_link carries, by name."""
    tracks: Mapping[str, FloatArray]
    """Middle of the flat run of each track in base_link, shape (3,) [m], by name."""

    @property
    def ride_height(self) -> float:
        """Height of base_link over the plane that the lowest of wheels and tracks touches, all joints at zero and the
        machine level [m]; 0 of one that has neither.
        """
        wheels = [wheel.radius - float(self.joints[wheel.joint].place[2]) for wheel in self.machine.wheels]
        return max([*wheels, *(-float(place[2]) for place in self.tracks.values())], default=0.0)


class MachineBody(NamedTuple):
    """What a mobility is made for."""

    layout: BodyLayout
    urdf_xml: str
    gravity: float
    """[m/s^2]"""
    stowed: Mapping[str, float]
    """Joints of the arm while the machine drives, by name [rad]; none where there is no arm."""

    @property
    def machine(self) -> MachineParams:
        """What it stands on, its drives and couplings."""
        return self.layout.machine
