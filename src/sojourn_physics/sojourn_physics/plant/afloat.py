"""How a machine begins that nothing holds: where it is let go, and how it moves then."""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.rotations import quaternion_of
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState
from sojourn_physics.plant.step import in_posture, unmoved


class AfloatStart(NamedTuple):
    """Of a machine that floats, its x, y and z axes turned by the yaw about those of map."""

    place: tuple[float, float, float]
    """Of the base in map [m]."""
    yaw: float
    """[rad]"""
    velocity: tuple[float, float, float]
    """Of the base in map [m/s]."""
    rates: tuple[float, float, float]
    """Of the base against map, about its own axes [rad/s]."""


def afloat_state(model: PlantModel, start: AfloatStart, soc: float, angles: dict[str, float]) -> PlantState:
    """The machine as it is let go, its joints where they are to start from.

    Args:
        soc: state of charge [0..1]. angles: of joints by name [rad]; zero for all others.

    Raises:
        InvalidValueError: unknown joint.
    """
    configuration, command = in_posture(model, angles)
    rotation = pin.utils.rotate("z", start.yaw)
    configuration[:3] = start.place
    configuration[3:7] = quaternion_of(rotation)
    state = unmoved(model, configuration, command, soc)
    state.velocity[:3] = rotation.T @ np.array(start.velocity)
    state.velocity[3:6] = start.rates
    return state
