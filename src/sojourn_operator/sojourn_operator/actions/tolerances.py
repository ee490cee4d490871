"""How far an arm may be from where it should be: tolerances of a FollowJointTrajectory goal.

As control_msgs/JointTolerance means them: a number above zero is a limit, zero and below are none (zero: whatever the
controller has itself; below: none at all).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sojourn_contract.values import JointState


@dataclass(frozen=True)
class Tolerance:
    """Of one joint: position [rad] or [m], velocity [rad/s] or [m/s]."""

    joint: str
    position: float
    velocity: float


def breach(
    tolerances: Sequence[Tolerance], wanted: Mapping[str, tuple[float, float]], measured: JointState | None
) -> str:
    """The first tolerance that is not kept, in words; empty where all are.

    Args:
        wanted: of each joint position and velocity, its names those of the tolerances that are looked at.
        measured: of the joints; None: nothing is known yet.
    """
    if measured is None:
        return ""
    has_rates = len(measured.velocity) == len(measured.names)
    places = {name: place for place, name in enumerate(measured.names)}
    for one in tolerances:
        if one.joint not in wanted or one.joint not in places:
            continue
        place = places[one.joint]
        position, velocity = wanted[one.joint]
        off = abs(position - float(measured.position[place]))
        if one.position > 0.0 and off > one.position:
            return f"{one.joint} is {off:.4f} from where it should be, tolerance {one.position:g}"
        off = abs(velocity - float(measured.velocity[place])) if has_rates else 0.0
        if one.velocity > 0.0 and off > one.velocity:
            return f"{one.joint} is {off:.4f} /s from the speed it should have, tolerance {one.velocity:g}"
    return ""
