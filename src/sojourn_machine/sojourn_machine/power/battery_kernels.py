"""Numba kernels of the battery: tables and one step, on pack-level scalars and contiguous float64 pack.

Equations, sources and range of validity are in `battery`. Tables rise strictly in x and have the same
length in y.
"""

from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray


class PackTables(NamedTuple):
    """What of a whole pack does not change, arrays contiguous."""

    soc: FloatArray
    """States of charge [1]."""
    ocv: FloatArray
    """Open-circuit voltage of the pack at `soc` [V]."""
    temperature: FloatArray
    """Temperatures of the resistances [K]."""
    ohmic: FloatArray
    """Ohmic resistance of the pack at `temperature` [ohm]."""
    polarisation: FloatArray
    """Polarisation resistance of the pack at `temperature` [ohm]."""
    charge_capacity: float
    """Charge of the full pack [C]."""
    capacitance: float
    """Of the polarisation pair [F]."""
    efficiency: float
    """Part of the charging current that is stored [1]."""
    heat_capacity: float
    """[J/K]"""
    conductance: float
    """To the surroundings [W/K]."""


@njit(cache=True)
def table_clamped(x_table: FloatArray, y_table: FloatArray, x: float) -> float:
    """Linear between the points of a rising table, constant beyond its ends."""
    last = x_table.shape[0] - 1
    if x <= x_table[0]:
        return float(y_table[0])
    if x >= x_table[last]:
        return float(y_table[last])
    i = np.searchsorted(x_table, x) - 1
    slope = (y_table[i + 1] - y_table[i]) / (x_table[i + 1] - x_table[i])
    return float(y_table[i] + slope * (x - x_table[i]))


@njit(cache=True)
def table_extrapolated(x_table: FloatArray, y_table: FloatArray, x: float) -> float:
    """Linear between the points of a rising table and along its first and last lines beyond them."""
    i = min(max(np.searchsorted(x_table, x) - 1, 0), x_table.shape[0] - 2)
    slope = (y_table[i + 1] - y_table[i]) / (x_table[i + 1] - x_table[i])
    return float(y_table[i] + slope * (x - x_table[i]))


@njit(cache=True)
def table_integral(x_table: FloatArray, y_table: FloatArray, x: float) -> float:
    """Integral of `table_extrapolated` from the first point of the table to x."""
    i = min(max(np.searchsorted(x_table, x) - 1, 0), x_table.shape[0] - 2)
    total = 0.0
    for k in range(i):
        total += 0.5 * (y_table[k] + y_table[k + 1]) * (x_table[k + 1] - x_table[k])
    return float(total + 0.5 * (y_table[i] + table_extrapolated(x_table, y_table, x)) * (x - x_table[i]))


@njit(cache=True)
def thevenin_kernel(
    soc_table: FloatArray,
    ocv_table: FloatArray,
    temperature_table: FloatArray,
    ohmic_table: FloatArray,
    soc: float,
    polarisation: float,
    temperature: float,
) -> tuple[float, float]:
    """`thevenin` on the pack's tables: source voltage [V] and resistance [ohm]."""
    resistance = table_clamped(temperature_table, ohmic_table, temperature)
    if soc <= 0.0:
        return 0.0, resistance
    return table_extrapolated(soc_table, ocv_table, soc) - polarisation, resistance


@njit(cache=True)
def step_kernel(
    pack: PackTables,
    soc: float,
    polarisation: float,
    temperature: float,
    current: float,
    dt: float,
    surroundings: float,
    side: float,
) -> tuple[float, float, float, float, float]:
    """One step: soc [1], polarisation [V], temperature [K], terminal energy [J], heat [J] of this step.

    Args:
        current: out of the pack positive [A]. dt: [s]. surroundings: their temperature [K].
        side: that empties the cells beside it, all of it heat [A].
    """
    charge_capacity, efficiency, heat_capacity = pack.charge_capacity, pack.efficiency, pack.heat_capacity
    r0 = table_clamped(pack.temperature, pack.ohmic, temperature)
    r1 = table_clamped(pack.temperature, pack.polarisation, temperature)

    # Source energy is OCV times current; charge not stored, for efficiency or a full pack, becomes heat.
    if current >= 0.0:
        soc_new = soc - current * dt / charge_capacity
        chemical = charge_capacity * (
            table_integral(pack.soc, pack.ocv, soc) - table_integral(pack.soc, pack.ocv, soc_new)
        )
        source = chemical
    else:
        stored = min(-efficiency * current * dt, max(1.0 - soc, 0.0) * charge_capacity)
        soc_new = soc + stored / charge_capacity
        chemical = charge_capacity * (
            table_integral(pack.soc, pack.ocv, soc) - table_integral(pack.soc, pack.ocv, soc_new)
        )
        overflow = max(-current * dt - stored / efficiency, 0.0)
        source = chemical / efficiency - overflow * table_extrapolated(pack.soc, pack.ocv, soc_new)
    side_heat = chemical - source
    if side > 0.0:
        drained = soc_new - side * dt / charge_capacity
        side_heat += charge_capacity * (
            table_integral(pack.soc, pack.ocv, soc_new) - table_integral(pack.soc, pack.ocv, drained)
        )
        soc_new = drained

    # v(t) = end + (v0 - end) exp(-t / tau), and the integrals of v and v^2 over the step.
    tau = r1 * pack.capacitance
    end = current * r1
    lead = polarisation - end
    fade = -np.expm1(-dt / tau)
    polarisation_new = end + lead * (1.0 - fade)
    integral_v = end * dt + lead * tau * fade
    integral_v2 = end * end * dt + lead * tau * fade * (2.0 * end + 0.5 * lead * (2.0 - fade))

    ohmic_heat = current * current * r0 * dt
    heat = ohmic_heat + integral_v2 / r1 + side_heat
    terminal = source - ohmic_heat - current * integral_v

    # First-order body, exact for heat spread evenly over the step; without conductance the limit dt.
    rate = pack.conductance / heat_capacity
    decay = -np.expm1(-rate * dt)
    spread = decay / rate if rate > 0.0 else dt
    temperature_new = temperature + (surroundings - temperature) * decay + heat / dt / heat_capacity * spread
    return soc_new, polarisation_new, temperature_new, terminal, heat
