"""Base of all parameter sets: frozen, validated once, unknown keys and non-finite numbers refused."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]


class Params(BaseModel):
    """A parameter set of one model. Its field names are the keys of the YAML file it is read from."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)
