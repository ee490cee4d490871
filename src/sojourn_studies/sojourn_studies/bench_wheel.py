"""Bench of the rigid wheel on soil: time of a call, error of its quadrature, a million cases over its whole range."""

import statistics
import time

import numpy as np

from sojourn_config.load import load_params
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_rim import Quadrature, RigidRim, RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, travel, wheel_forces
from sojourn_physics.soil.params import SoilParams, kernel_row

ROUNDS = 15
CALLS = 20_000
FINE_POINTS = 500
"""On each side of the angle of greatest stress: 1000 in all."""
SOILS = {"plain": "lunar_nominal", "all terms": "cmu_sand"}
EARTH = 9.81
RIM = RigidRim(0.125, 0.131, 0.16, 30.0, 0.001)
TARGETS = {
    "rigid wheel on soil, plain [us]": ("<=", 2.0),
    "rigid wheel on soil, all terms [us]": ("<=", 2.0),
    "quadrature against 1000 points, plain [%]": ("<=", 0.1),
    "quadrature against 1000 points, all terms [%]": ("<=", 0.1),
    "cases that are not finite": ("<=", 0.0),
    "cases that give energy": ("<=", 0.0),
}


@njit
def _time(cases: FloatArray, soil: FloatArray, quadrature: Quadrature) -> float:
    total = 0.0
    for i in range(cases.shape[0]):
        z, slip, lateral, rolling = cases[i]
        total += wheel_forces(RIM, EARTH, RimContact(z, slip, lateral, rolling), soil, quadrature)[2]
    return total


@njit
def _survey(cases: FloatArray, soil: FloatArray, quadrature: Quadrature) -> tuple[int, int]:
    """Number of cases with a force that is not finite, and of those in steady motion that give energy."""
    wild = giving = 0
    for i in range(cases.shape[0]):
        z, slip, lateral, rolling = cases[i]
        found = wheel_forces(RIM, EARTH, RimContact(z, slip, lateral, rolling), soil, quadrature)
        rim_speed, ahead, _, _ = travel(slip, lateral)
        given = found[3] * rim_speed / RIM.radius - found[0] * ahead + found[1] * lateral
        exchanged = abs(found[3]) * rim_speed / RIM.radius + abs(found[0] * ahead) + abs(found[1] * lateral)
        if not np.isfinite(exchanged + abs(found[2]) + abs(found[4]) + abs(found[5])):
            wild += 1
        elif rolling == 1.0 and given < -1e-9 * exchanged:
            giving += 1
    return wild, giving


def bench_wheel(cases: int) -> dict[str, float]:
    """Figures by name, with a survey of so many cases; times are medians over rounds."""
    random = np.random.default_rng(0)
    figures: dict[str, float] = {}
    for label, name in SOILS.items():
        soil = kernel_row(load_params("soils", name, SoilParams))
        calls = _cases(random, CALLS)
        _time(calls[:10], soil, QUADRATURE)
        samples = []
        for _ in range(ROUNDS):
            begin = time.process_time()  # other processes do not count
            _time(calls, soil, QUADRATURE)
            samples.append((time.process_time() - begin) / CALLS * 1e6)
        figures[f"rigid wheel on soil, {label} [us]"] = statistics.median(samples)
        figures[f"quadrature against 1000 points, {label} [%]"] = _quadrature_error(calls[:300], soil)
    wild = giving = 0
    soils = [kernel_row(load_params("soils", name, SoilParams)) for name in (*SOILS.values(), "snow", "ding_2011")]
    for soil in soils:
        found = _survey(_cases(random, cases // len(soils), sinkage=3.0 * RIM.radius), soil, QUADRATURE)
        wild, giving = wild + found[0], giving + found[1]
    figures |= {"cases": float(cases), "cases that are not finite": wild, "cases that give energy": giving}
    return figures


def _cases(random: np.random.Generator, count: int, sinkage: float = 0.04) -> FloatArray:
    """Sinkage, slip, lateral slip and rolling over their whole range, (count, 4); half of them in steady motion."""
    return np.stack(
        [
            sinkage * random.uniform(0.0, 1.0, count) ** 2,
            random.uniform(-1.0, 1.0, count),
            random.uniform(-1.0, 1.0, count),
            np.minimum(random.uniform(0.0, 2.0, count), 1.0),
        ],
        axis=1,
    )


def _quadrature_error(cases: FloatArray, soil: FloatArray) -> float:
    """99th percentile of the error of the force, over the force [%]."""
    points, weights = np.polynomial.legendre.leggauss(FINE_POINTS)
    errors = []
    for z, slip, lateral, rolling in cases:
        given = (RIM, EARTH, RimContact(z, slip, lateral, rolling), soil)
        fine = np.array(wheel_forces(*given, Quadrature(0.5 * (points + 1.0), 0.5 * weights))[:3])
        coarse = np.array(wheel_forces(*given, QUADRATURE)[:3])
        errors.append(np.linalg.norm(coarse - fine) / (np.linalg.norm(fine) + 1e-9))
    return 100.0 * float(np.percentile(errors, 99.0))
