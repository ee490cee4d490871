"""The sum's short cut says what looking at each number says."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sojourn_machine.finite import all_finite
from sojourn_machine.params import FloatArray


@given(arrays(np.float64, st.integers(0, 6), elements=st.floats(width=64)))
def test_it_is_what_looking_at_each_number_says(array: FloatArray) -> None:
    assert all_finite(array) == bool(np.isfinite(array).all())


def test_a_sum_that_is_too_large_is_no_fault_of_its_numbers() -> None:
    assert all_finite(np.full((2, 2), 1e308))
    assert not all_finite(np.array((np.inf, -np.inf)))
