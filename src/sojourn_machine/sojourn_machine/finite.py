"""Whether numbers are numbers, for checks that are made many times a period."""

from math import isfinite

import numpy as np

from sojourn_machine.params import FloatArray


def all_finite(array: FloatArray) -> bool:
    """Whether all of a few numbers are finite.

    A sum is not finite where one of its numbers is not, and may be too large where all are.
    """
    return isfinite(sum(array.ravel().tolist())) or bool(np.isfinite(array).all())
