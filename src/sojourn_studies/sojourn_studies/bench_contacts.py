"""The contact laws in the bench: what a call of each costs, and a million random cases that must stay finite."""

import time

import numpy as np
from numpy.typing import NDArray

from sojourn_analysis.wheels.examples import LAWS, example_row
from sojourn_analysis.wheels.survey import STEPS, count_not_finite, random_motions, survey
from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_physics.contact.contact_law import STATE_COLUMNS, MotionColumn
from sojourn_physics.soil.params import SoilParams, kernel_table

NOT_FINITE = "contact laws, cases that are not finite"
TIMED_CASES = 2000


def bench_contacts(cases: int) -> dict[str, float]:
    """So many random cases of all laws on all soils that are not finite, and microseconds of a call of each law."""
    soils = kernel_table([load_params("soils", name, SoilParams) for name in available("soils")])
    shares = np.full(len(LAWS), cases // len(LAWS))
    shares[: cases % len(LAWS)] += 1
    not_finite = 0
    costs: dict[str, float] = {}
    for number, (model, share) in enumerate(zip(LAWS, shares, strict=True)):
        row = example_row(model)
        not_finite += survey(row, soils, int(share), seed=number)
        motions = _driving(TIMED_CASES)
        steps = np.full(TIMED_CASES, 1e-3)
        states = np.zeros((TIMED_CASES, STATE_COLUMNS))
        begin = time.perf_counter()
        count_not_finite(row, soils, motions, steps, states)
        cost = (time.perf_counter() - begin) / (STEPS * TIMED_CASES) * 1e6
        costs[f"  {model} [us]"] = cost
    return {"contact laws, cases": float(cases), NOT_FINITE: float(not_finite), **costs}


def _driving(count: int) -> NDArray[np.float64]:
    """Motions of wheels that drive: millimetres deep, decimetres a second, upright."""
    generator = np.random.default_rng(1)
    motions = random_motions(count, generator)
    motions[:, MotionColumn.PENETRATION] = generator.uniform(1e-3, 2e-2, count)
    for column in (MotionColumn.V_ALONG, MotionColumn.RIM_SPEED):
        motions[:, column] = generator.uniform(0.0, 0.3, count)
    for column in (MotionColumn.V_SIDE, MotionColumn.V_NORMAL, MotionColumn.YAW_RATE, MotionColumn.ROLL_RATE):
        motions[:, column] = generator.uniform(-0.02, 0.02, count)
    motions[:, MotionColumn.CAMBER] = generator.uniform(-0.05, 0.05, count)
    return motions
