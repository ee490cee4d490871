"""Steps of heat in the ground in compiled code; see `regolith` for the equations."""

from typing import Any, NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN

_CLOSE = 1e-9
"""Change of the last iterate [K]."""
_ITERATIONS = 60


class Layers(NamedTuple):
    """A ground of N nodes, as the kernels take it."""

    mass: FloatArray
    """Of the layer of each node, shape (N,) [kg/m2]."""
    contact: FloatArray
    """Conductance of the contacts between neighbours, shape (N - 1,) [W/(m2 K)]."""
    radiative: float
    heat_capacity: FloatArray
    emissivity: float
    heat_flow: float


@njit(cache=True)
def advance_kernel(
    layers: Any, start: FloatArray, given: FloatArray, dt: float, over_time: FloatArray, fluxes: FloatArray
) -> None:
    """Fill `over_time`, shape (M, N) [K], and `fluxes`, shape (M, N + 1) [W/m2]."""
    count = start.size
    conductance = np.empty(count - 1)
    diagonal = np.empty(count)
    right = np.empty(count)
    ratio = np.empty(count)
    held = np.empty(count)
    c = layers.heat_capacity
    before = start
    for m in range(given.shape[0]):
        now = over_time[m]
        flux = fluxes[m]
        now[:] = before
        for i in range(count):
            held[i] = _heat(c, before[i])
        for _ in range(_ITERATIONS):
            _flows(layers, now, given[m], conductance, flux)
            for i in range(count):
                storing = layers.mass[i] / dt
                right[i] = flux[i] - flux[i + 1] - storing * (_heat(c, now[i]) - held[i])
                diagonal[i] = storing * _specific_heat(c, now[i])
            diagonal[0] += 4.0 * layers.emissivity * STEFAN_BOLTZMANN * now[0] ** 3 + given[m, 2]
            for i in range(count - 1):
                diagonal[i] += conductance[i]
                diagonal[i + 1] += conductance[i]
            for i in range(1, count):  # Thomas: what stands beside the diagonal is -conductance, on both sides
                ratio[i] = conductance[i - 1] / diagonal[i - 1]
                diagonal[i] -= ratio[i] * conductance[i - 1]
                right[i] += ratio[i] * right[i - 1]
            change = right[count - 1] / diagonal[count - 1]
            largest = abs(change)
            now[count - 1] += change
            for i in range(count - 2, -1, -1):
                change = (right[i] + conductance[i] * change) / diagonal[i]
                largest = max(largest, abs(change))
                now[i] = max(now[i] + change, 0.5 * now[i])
            if largest < _CLOSE:
                break
        _flows(layers, now, given[m], conductance, flux)
        before = now


@njit(cache=True)
def _flows(layers: Any, now: FloatArray, given: FloatArray, conductance: FloatArray, flux: FloatArray) -> None:
    """Conductances between the nodes and the heat that goes down, with the temperatures `now`."""
    count = now.size
    flux[0] = (
        given[0] + layers.emissivity * (given[1] - STEFAN_BOLTZMANN * now[0] ** 4) + given[2] * (given[3] - now[0])
    )
    for i in range(count - 1):
        mean = 0.5 * (now[i] + now[i + 1]) / 350.0
        conductance[i] = layers.contact[i] * (1.0 + layers.radiative * mean**3)
        flux[i + 1] = conductance[i] * (now[i] - now[i + 1])
    flux[count] = -layers.heat_flow


@njit(cache=True)
def _heat(c: FloatArray, temperature: float) -> float:
    t = temperature
    heat: float = t * (c[0] + t * (c[1] / 2.0 + t * (c[2] / 3.0 + t * (c[3] / 4.0 + t * c[4] / 5.0))))
    return heat


@njit(cache=True)
def _specific_heat(c: FloatArray, temperature: float) -> float:
    t = temperature
    specific: float = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])))
    return specific
