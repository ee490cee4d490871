"""Checks of keep-out zones: names that are there once, a start and goals that are outside."""

import typing
from collections.abc import Iterable, Iterator

import numpy as np

from sojourn_config.errors import Problem
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_flight.hazards.zone_params import first_in

if typing.TYPE_CHECKING:
    from sojourn_config.scenario import ScenarioConfig


def zone_problems(config: "ScenarioConfig", document: YamlDocument) -> Iterator[Problem]:
    """Of the zones themselves, and of the start."""
    for index, zone in enumerate(config.keep_out):
        if any(other.name == zone.name for other in config.keep_out[:index]):
            allowed = "is there above already: allowed is each name once"
            yield document.problem(("keep_out", index, "name"), zone.name, allowed)
    yield from zone_place_problems(config, [(("start",), config.start.x, config.start.y)], document)


def zone_place_problems(
    config: "ScenarioConfig", places: Iterable[tuple[KeyPath, float, float]], document: YamlDocument
) -> Iterator[Problem]:
    """Of places to which the drive is to come."""
    for path, x, y in places:
        found = first_in(config.keep_out, np.array([[x, y]]))
        if found is not None:
            allowed = f"lies in the keep-out zone {found[1].name}: allowed is a place outside"
            yield document.problem(path, f"({x:g}, {y:g})", allowed)
