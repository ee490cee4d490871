"""A root and a peak of a function of one number, to the last digits, the same on every machine."""

from collections.abc import Callable

GOLDEN = 0.6180339887498949
HALVINGS, SECTIONS = 60, 80


def root_of(rising: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that rises from low to high is 0; an end where it has one sign all the way."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if rising(middle) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def peak_of(single: Callable[[float], float], low: float, high: float) -> float:
    """Where a function with one peak from low to high has it; of a level stretch, its lower end."""
    ends = low, high
    for _ in range(SECTIONS):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        if single(left) < single(right):
            low = left
        else:
            high = right
    return max(*ends, 0.5 * (low + high), key=single)
