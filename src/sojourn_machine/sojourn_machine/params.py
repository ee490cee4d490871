"""Base of all parameter sets: frozen, validated once, unknown keys and non-finite numbers refused."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]


class Params(BaseModel):
    """A parameter set of one model. Its field names are the keys of the YAML file it is read from."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True, defer_build=True)


def require_rising(name: str, values: tuple[float, ...]) -> None:
    """Refuse a table whose numbers do not rise. Raises ValueError."""
    for i in range(1, len(values)):
        if not values[i] > values[i - 1]:
            raise ValueError(f"{name}[{i}] = {values[i]}: allowed is above {values[i - 1]}, the value before it")
