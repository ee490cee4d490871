"""Light at the machine where it starts: what its power manager expects, and what a plan of its days goes by."""

from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from sojourn_config.flight import FlightScenario
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.power_manager.preview import Around
from sojourn_machine.power.surroundings import DARK, UPRIGHT, PowerSurroundings
from sojourn_machine.sunlight import Sunlight
from sojourn_physics.terrain.height_field import HeightField

Sited: TypeAlias = LoadedScenario | FlightScenario
"""A machine with its start and the Sun over it: in truth, or as it is believed to be."""
LightAtStart: TypeAlias = Callable[[float], Sunlight]
"""By the time after the start of the run [s]."""


def light_at_start(scenario: Sited, terrain: Callable[[], HeightField] | None = None) -> LightAtStart:
    """Sunlight where the machine starts. terrain: makes the ground, where it may hide the Sun; left out: only the far
    horizon does.
    """
    sun, start = scenario.sun_over(terrain), scenario.start

    @lru_cache(maxsize=4096)  # several ask for one moment, and forecasts for the same hours again and again
    def light(time: float) -> Sunlight:
        return sun.light(time, start.x, start.y)

    return light


def light_on_machine(scenario: Sited, light: LightAtStart) -> Around:
    """On the machine, level and headed as at its start; darkness where no source goes by light."""
    if not any(source.takes_light for source in scenario.power.sources.values()):
        return lambda _: DARK
    cosine, sine = np.cos(scenario.start.yaw), np.sin(scenario.start.yaw)
    base_from_map = np.array(((cosine, sine, 0.0), (-sine, cosine, 0.0), (0.0, 0.0, 1.0)))

    def around(time: float) -> PowerSurroundings:
        here = light(time)
        return PowerSurroundings(base_from_map @ here.direction, here.direct, here.diffuse, UPRIGHT)

    return around


MOMENTS = 96
"""Of a solar day that are looked at for light."""


def lies_in_the_dark(scenario: LoadedScenario) -> bool:
    """Whether all sources of a machine go by light, and none comes to its site in the solar day from the start of the
    run on. Of the ground about it nothing is asked.
    """
    if not goes_by_light(scenario):
        return False
    light, step = light_at_start(scenario), scenario.body.solar_day / MOMENTS
    return is_dark(light(place * step) for place in range(MOMENTS))


def goes_by_light(scenario: LoadedScenario) -> bool:
    """Whether all sources of a machine do, of which it has one at least."""
    sources = scenario.power.sources.values()
    return bool(sources) and all(source.takes_light for source in sources)


def is_dark(lights: Iterable[Sunlight | PowerSurroundings]) -> bool:
    """Whether none of them is any."""
    return all(one.direct <= 0.0 and one.diffuse <= 0.0 for one in lights)


def expected_light(scenario: FlightScenario, light: LightAtStart | None = None) -> Around:
    """As the machine's computer expects it: of the ground about it nothing is known before it has been seen.

    Args:
        light: where the machine starts, which keeps the moments that its heat asks for as well (`heat_at_start`).
    """
    return light_on_machine(scenario, light or light_at_start(scenario))
