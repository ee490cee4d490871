"""Survey of the contact laws over random input: is every answer finite.

Inputs are drawn from their whole range, sizes and speeds evenly in their logarithm: penetration of 1e-12 to 5 m,
speeds of 1e-9 to 1e3 m/s and rates alike, any camber below 87 degrees, any memory, steps of 1e-5 to 5e-3 s.
"""

import math

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import (
    MOTION_COLUMNS,
    OUT_COLUMNS,
    STATE_COLUMNS,
    MotionColumn,
)
from sojourn_physics.contact.law_call import apply_law

STEPS = 3
CHUNK = 20_000
RATES = (
    MotionColumn.V_ALONG, MotionColumn.V_SIDE, MotionColumn.V_NORMAL, MotionColumn.RIM_SPEED, MotionColumn.YAW_RATE,
    MotionColumn.ROLL_RATE,
)  # fmt: skip


@njit(cache=True)
def count_not_finite(
    wheel: FloatArray, soils: FloatArray, motions: FloatArray, steps: FloatArray, states: FloatArray
) -> int:
    """Cases after which a force or a state is not finite.

    Args:
        wheel: row of a wheel. soils: (soils, columns), taken in turn. motions: (cases, MOTION_COLUMNS).
        steps: (cases,) [s]. states: (cases, STATE_COLUMNS), advanced.
    """
    bad = 0
    out = np.empty(OUT_COLUMNS)
    for i in range(motions.shape[0]):
        for _ in range(STEPS):
            out[:] = 0.0
            apply_law(wheel, soils[i % soils.shape[0]], motions[i], steps[i], states[i], out)
        if not (np.isfinite(out).all() and np.isfinite(states[i]).all()):
            bad += 1
    return bad


def random_motions(count: int, generator: np.random.Generator) -> FloatArray:
    """Motions of the survey: (count, MOTION_COLUMNS)."""
    motions = np.zeros((count, MOTION_COLUMNS))
    motions[:, MotionColumn.PENETRATION] = 10.0 ** generator.uniform(-12.0, math.log10(5.0), count)
    for column in RATES:
        size = 10.0 ** generator.uniform(-9.0, 3.0, count)
        motions[:, column] = size * generator.choice([-1.0, 0.0, 1.0], count)
    motions[:, MotionColumn.CAMBER] = generator.uniform(-0.999, 0.999, count)
    return motions


def survey(wheel: FloatArray, soils: FloatArray, cases: int, seed: int = 0) -> int:
    """How many of so many random cases of one law do not end in finite numbers.

    Args:
        wheel: row of a wheel. soils: (soils, columns).
    """
    generator = np.random.default_rng(seed)
    bad = 0
    for first in range(0, cases, CHUNK):
        count = min(CHUNK, cases - first)
        motions = random_motions(count, generator)
        steps = 10.0 ** generator.uniform(-5.0, math.log10(5e-3), count)
        states = generator.uniform(-1.0, 1.0, (count, STATE_COLUMNS))
        bad += int(count_not_finite(wheel, soils, motions, steps, states))
    return bad
