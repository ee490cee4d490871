"""Uncertainty of a soil's parameters, and soils drawn from it.

A field's spread is a standard deviation, drawn from a normal distribution, or a lowest and highest value, drawn from a
uniform one. Fields are drawn independently (fits give correlated ones: a band so drawn is too wide rather than too
narrow); a draw that is no soil is drawn again.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError

if TYPE_CHECKING:
    from sojourn_physics.soil.params import SoilParams

MAX_ATTEMPTS = 1000
NUMBER_TYPES = (float, float | None)


def check_spread(fields: Mapping[str, Any], spread: Mapping[str, float | tuple[float, float]]) -> None:
    """Refuse spreads of what is no number of a soil, and those that are none.

    Args:
        fields: of the soil, by name.

    Raises:
        InvalidValueError: as said.
    """
    for name, value in spread.items():
        if name not in fields or fields[name].annotation not in NUMBER_TYPES:
            raise InvalidValueError("spread", name, "numeric fields of a soil")
        numbers = value if isinstance(value, tuple) else (0.0, value)
        if not (all(math.isfinite(x) for x in numbers) and numbers[0] <= numbers[1]):
            raise InvalidValueError(f"spread of {name}", value, "a standard deviation of at least 0, or [low, high]")


def draw_soils(soil: "SoilParams", count: int, seed: int) -> list["SoilParams"]:
    """Soils within the spread of `soil`; the same for the same seed.

    Raises:
        InvalidValueError: a spread from which hardly any draw is a soil.
    """
    random = np.random.default_rng(seed)
    given = soil.model_dump()
    drawn: list[SoilParams] = []
    for _ in range(MAX_ATTEMPTS + count):
        if len(drawn) == count:
            return drawn
        changes = {}
        for name, value in soil.spread.items():
            if isinstance(value, tuple):
                changes[name] = float(random.uniform(*value))
            elif given[name] is not None:
                changes[name] = float(random.normal(given[name], value))
        try:
            drawn.append(type(soil).model_validate({**given, **changes}))
        except (ValidationError, InvalidValueError):
            continue
    if len(drawn) < count:
        raise InvalidValueError("spread", dict(soil.spread), f"one from which a soil can be drawn: soil {soil.name}")
    return drawn
