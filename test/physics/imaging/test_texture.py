"""Octaves of the grain, against their logarithm."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.imaging.texture import FINEST, grain, octave_for

LOOK = grain(0.05, 0.04, 0.1)


@settings(max_examples=200, deadline=None)
@given(st.floats(1e-6, 1e3), st.integers(0, 25))
def test_the_first_octave_is_that_of_the_logarithm_whatever_the_guess(width: float, guess: int) -> None:
    widest = math.floor(math.log2(LOOK.widest / FINEST)) + 1
    expected = max(math.frexp(width / FINEST)[1], 0)
    assert min(octave_for(LOOK, width, guess), widest) == min(expected, widest)
