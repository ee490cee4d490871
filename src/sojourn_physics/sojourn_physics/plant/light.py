"""Sunlight on the machine as it stands, in map and as its power network takes it."""

import math

import numpy as np

from sojourn_machine.power.surroundings import DARK, PowerSurroundings
from sojourn_machine.sunlight import Sunlight
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState
from sojourn_physics.plant.supply_kernels import in_base

DARKNESS = Sunlight(np.array((0.0, 0.0, -1.0)), 0.0, 0.0, -0.5 * math.pi, 0.0)
"""A Sun at the nadir."""


def sunlight_on(model: PlantModel, state: PlantState) -> Sunlight:
    """What shines on the machine in a state; darkness on a site without a Sun."""
    if model.sun is None:
        return DARKNESS
    x, y = state.configuration[:2]
    return model.sun.light(state.tick * model.simulation.control_period, float(x), float(y))


def light_for_power(model: PlantModel, state: PlantState) -> Sunlight:
    """The same as power and heat take it, held over each second."""
    if model.sun is None:
        return DARKNESS
    x, y, *_ = state.configuration.tolist()
    return model.sun.held_light(state.tick * model.simulation.control_period, x, y)


def surroundings_of(
    model: PlantModel, state: PlantState, round_stores: tuple[float | None, ...] = ()
) -> PowerSurroundings:
    """What the power network is told of the light and of what is round its stores, where that is known [K]."""
    if not model.power.takes_light:
        return PowerSurroundings(round_stores=round_stores) if round_stores else DARK
    light = light_for_power(model, state)
    to_sun, up = in_base(state.configuration, light.direction)
    return PowerSurroundings(to_sun, light.direct, light.diffuse, up, None, round_stores)
