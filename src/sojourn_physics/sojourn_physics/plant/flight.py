"""Whether a machine that stands on the ground has left it, and whether it will come back.

It is off the ground at the end of a control period in which none of its supports feels a force. On Itokawa, where a
wheel that spins throws a rover up at a walking pace, that may be for good: when it flies faster than the body's
speed of escape (`environment/gravity/field`).
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import FORCE
from sojourn_machine.params import FloatArray

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantModel

LONG = 10.0
"""Off the ground for so long, a machine flies; what rolls over rocks touches the ground again sooner [s]."""


class Flight(NamedTuple):
    """Of a machine that is not held by its foundation."""

    periods: int = 0
    """Control periods since a support last touched the ground."""
    long: bool = False
    """Has been off the ground for `LONG` at a time since the start."""
    escaped: bool = False
    """Has been off the ground at more than the speed of escape since the start."""


STANDING = Flight()
"""On the ground."""


def flight_after(model: "PlantModel", before: Flight, configuration: FloatArray, velocity: FloatArray) -> Flight:
    """After a period whose contacts are in the model's report; the machine as it is then, (nq,), (nv,)."""
    free = not model.machine.fixed_base and model.gravity > 0.0
    if not free or np.count_nonzero(model.report[:, FORCE]):
        return before if before.periods == 0 else before._replace(periods=0)
    periods = before.periods + 1
    speed = pin.Quaternion(configuration[3:7]) * velocity[:3]
    return Flight(
        periods,
        before.long or periods * model.simulation.control_period >= LONG,
        before.escaped or model.field.escapes(configuration[:3], speed),
    )
