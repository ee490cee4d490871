"""The thermal network in compiled code; see `network` for the equations."""

from typing import Any, NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray

STEFAN_BOLTZMANN = 5.670374419e-8
"""[W/(m2 K4)] (CODATA 2018)."""
ACCOUNT = 2
"""Sums that the kernel keeps: heat of heaters, heat from outside [J]."""
_GAMMA = 1.0 - 0.7071067811865476
_TOLERANCE = 0.02
"""Of a step against that of order 1 [K]."""
_OVERSHOOT = 0.02
"""Past the temperature at which a thermostat switches [K]."""
_CLOSE = 1e-5
"""Change of the last iterate [K]: Newton's method squares the error, so that some 10^-13 K is left."""
_ITERATIONS = 30
_SHORTEST = 1e-6
"""Part of the whole step that is taken whatever its error."""


class Rows(NamedTuple):
    """What does not change of N nodes. Emissivities and absorptivities are in the areas."""

    capacity: FloatArray
    conductance: FloatArray
    """Symmetric, shape (N, N) [W/K]."""
    exchange: FloatArray
    """Symmetric, shape (N, N) [m2]."""
    sky: FloatArray
    ground: FloatArray
    to_ground: FloatArray
    air: FloatArray
    sun: FloatArray


class Outside(NamedTuple):
    """What holds over a step."""

    ground: float
    sky: float
    air: float
    convection: float
    heat: FloatArray
    """Given to the nodes by all but the heaters, shape (N,) [W]."""


class Thermostats(NamedTuple):
    """Of K heaters."""

    node: IntArray
    power: FloatArray
    on_below: FloatArray
    off_above: FloatArray


class Account(NamedTuple):
    """What a step changes."""

    temperatures: FloatArray
    heating: FloatArray
    heater_energy: FloatArray
    sums: FloatArray


@njit(cache=True)
def step_kernel(rows: Any, outside: Any, thermostats: Any, account: Any, fed: FloatArray, dt: float) -> None:
    """Bring `account` forward by dt [s]."""
    now = account.temperatures
    count = now.size
    heat = np.empty(count)
    matrix = np.empty((count, count))
    first, second, base = np.empty(count), np.empty(count), np.empty(count)
    rate_first, rate_second = np.empty(count), np.empty(count)
    left, size = dt, dt
    while left > 0.0:
        size = min(size, left)
        _heat_of_heaters(outside, thermostats, account.heating, fed, heat)
        first[:] = now
        drawn_first = _stage(rows, outside, heat, now, _GAMMA * size, first, rate_first, matrix)
        for i in range(count):
            base[i] = now[i] + (1.0 - _GAMMA) * size * rate_first[i]
            second[i] = now[i] + size * rate_first[i]
        drawn_second = _stage(rows, outside, heat, base, _GAMMA * size, second, rate_second, matrix)
        error = 0.0
        for i in range(count):
            error = max(error, abs(_GAMMA * size * (rate_second[i] - rate_first[i])))
        past, share = _past_a_threshold(thermostats, account.heating, now, second)
        if size > _SHORTEST * dt and (error > _TOLERANCE or past > _OVERSHOOT):
            shrink = max(0.2, 0.8 * (_TOLERANCE / error) ** 0.5) if error > _TOLERANCE else 1.0
            if past > _OVERSHOOT:
                shrink = min(shrink, max(share, 0.01))
            size *= min(shrink, 0.95)
            continue
        now[:] = second
        account.sums[1] += size * ((1.0 - _GAMMA) * drawn_first + _GAMMA * drawn_second)
        for k in range(thermostats.node.size):
            energy = size * account.heating[k] * fed[k] * thermostats.power[k]
            account.heater_energy[k] += energy
            account.sums[0] += energy
            temperature = now[thermostats.node[k]]
            if temperature < thermostats.on_below[k]:
                account.heating[k] = 1.0
            elif temperature > thermostats.off_above[k]:
                account.heating[k] = 0.0
        left -= size
        if left < 1e-12 * dt:
            left = 0.0
        size *= min(3.0, 0.8 * (_TOLERANCE / max(error, 1e-9)) ** 0.5)


@njit(cache=True)
def _heat_of_heaters(outside: Any, thermostats: Any, heating: FloatArray, fed: FloatArray, heat: FloatArray) -> None:
    heat[:] = outside.heat
    for k in range(thermostats.node.size):
        heat[thermostats.node[k]] += heating[k] * fed[k] * thermostats.power[k]


@njit(cache=True)
def _past_a_threshold(thermostats: Any, heating: FloatArray, now: FloatArray, then: FloatArray) -> tuple[float, float]:
    """How far [K] the thermostat that is to switch first goes past, and the share of the step before it."""
    past, share = 0.0, 1.0
    for k in range(thermostats.node.size):
        before, after = now[thermostats.node[k]], then[thermostats.node[k]]
        if heating[k] > 0.5:
            threshold, beyond = thermostats.off_above[k], after - thermostats.off_above[k]
        else:
            threshold, beyond = thermostats.on_below[k], thermostats.on_below[k] - after
        if beyond > _OVERSHOOT and abs(after - before) > 0.0:
            crossed = abs(threshold - before) + 0.5 * _OVERSHOOT  # a little past it, so that it does switch
            past = max(past, beyond)
            share = min(share, crossed / abs(after - before))
    return past, share


@njit(cache=True)
def _stage(
    rows: Any,
    outside: Any,
    heat: FloatArray,
    base: FloatArray,
    span: float,
    at: FloatArray,
    rate: FloatArray,
    matrix: FloatArray,
) -> float:
    """Solve at = base + span rate(at) from the guess `at`; returns the heat that then comes from outside [W]."""
    count = base.size
    for _ in range(_ITERATIONS):
        _rates(rows, outside, heat, at, rate, matrix)
        for i in range(count):
            for j in range(count):
                matrix[i, j] *= -span
            matrix[i, i] += 1.0
            rate[i] = base[i] + span * rate[i] - at[i]
        if _solve(matrix, rate, at) < _CLOSE:
            break
    drawn: float = _rates(rows, outside, heat, at, rate, matrix)
    return drawn


@njit(cache=True)
def _rates(rows: Any, outside: Any, heat: FloatArray, at: FloatArray, rate: FloatArray, matrix: FloatArray) -> float:
    """Rates [K/s], their derivatives [1/s], and the heat from outside [W]."""
    drawn = 0.0
    sky, ground = STEFAN_BOLTZMANN * outside.sky**4, STEFAN_BOLTZMANN * outside.ground**4
    count = at.size
    for i in range(count):
        cube = STEFAN_BOLTZMANN * at[i] * at[i] * at[i]
        fourth = cube * at[i]
        air = outside.convection * rows.air[i]
        out = (
            rows.sky[i] * (sky - fourth)
            + rows.ground[i] * (ground - fourth)
            + rows.to_ground[i] * (outside.ground - at[i])
            + air * (outside.air - at[i])
        )
        drawn += out
        slope = -4.0 * (rows.sky[i] + rows.ground[i]) * cube - rows.to_ground[i] - air
        total = heat[i] + out
        for j in range(count):
            g, a = rows.conductance[i, j], rows.exchange[i, j]
            matrix[i, j] = 0.0
            if g == 0.0 and a == 0.0:
                continue
            cube_there = STEFAN_BOLTZMANN * at[j] * at[j] * at[j]
            total += g * (at[j] - at[i]) + a * (cube_there * at[j] - fourth)
            slope -= g + 4.0 * a * cube
            matrix[i, j] = (g + 4.0 * a * cube_there) / rows.capacity[i]
        matrix[i, i] = slope / rows.capacity[i]
        rate[i] = total / rows.capacity[i]
    return drawn


@njit(cache=True)
def _solve(matrix: FloatArray, right: FloatArray, at: FloatArray) -> float:
    """Add to `at` the solution by elimination, and return its largest entry. No pivots are sought: heat that leaves a
    node arrives at another, so with the capacities as weights the diagonal dominates its column.
    """
    count = right.size
    for k in range(count):
        for i in range(k + 1, count):
            if matrix[i, k] != 0.0:
                factor = matrix[i, k] / matrix[k, k]
                for j in range(k + 1, count):
                    matrix[i, j] -= factor * matrix[k, j]
                right[i] -= factor * right[k]
    largest = 0.0
    for i in range(count - 1, -1, -1):
        for j in range(i + 1, count):
            right[i] -= matrix[i, j] * right[j]
        right[i] /= matrix[i, i]
        largest = max(largest, abs(right[i]))
    for i in range(count):
        at[i] = max(at[i] + right[i], 0.5 * at[i])
    return largest
