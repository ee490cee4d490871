"""Vectors in space."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sojourn_machine.vectors import cross

VECTORS = arrays(np.float64, 3, elements=st.floats(-1e6, 1e6))


@given(VECTORS, VECTORS)
def test_the_cross_product_is_that_of_the_library(a: np.ndarray, b: np.ndarray) -> None:
    np.testing.assert_array_equal(cross(a, b), np.cross(a, b))
