"""Numba kernels of a bus: the voltage at which stores, sources, a converter and loads meet, and who gives what.

Equations. Stores of force E_k behind R_k, sources of at most P_i and I_i, loads of constant power P and conductance G
share the bus at voltage V:

    sum_k (E_k - V) / R_k + sum_i min(P_i / V, I_i) = P / V + G V

A store that may not be charged or not be discharged is left out where its current would flow that way, and one that
limits its current to M_k gives that where it would be more, so the left side is made of pieces; its edges are E_k,
E_k - R_k M_k and P_i / I_i. In each piece stores add up to one force E behind one resistance R, and

    (1 + R G) V^2 - (E - R I0) V + R (P - sum P_i) = 0,    I0 = -sum I_i - sum M_k

Its upper root is the stable operating point (Middlebrook 1976, "Input filter considerations", IEEE IAS: a load of
constant power has a negative incremental resistance); pieces are tried from the highest voltage down. Where none has
a root the loads ask for more than can be given: the bus is browned out, sits at the point of most power, and the
loads share what there is.

Sources and the converter do not lift the bus above its target: the voltage that the converter holds, and the ceilings
of its stores. What the sources give falls short of what they can in the order of the file, the last first. Power that
comes back from loads goes into the stores whatever their ceiling, and into a shunt where there is none to take it.
Assumption: no dynamics of the bus capacitor (settles in well under a millisecond).
"""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_machine.power.loads import LoadColumns

FORCE, RESISTANCE, CEILING, DISCHARGES, CHARGES, MOST = range(6)
"""Columns of a table of stores, as `StorePoint`."""
POWER, CURRENT = range(2)
"""Columns of a table of sources, as `SourcePoint`."""
VOLTAGE, SERVED, USED, DRAWN, FED, SHUNT = range(6)
FLOWS = 6
"""What is found of a bus: voltage [V], part served [1]; power of all loads, into the converters that it feeds, from the
one that feeds it, and into the shunt [W].
"""
LEAST_VOLTAGE = 1e-9
"""At which anything flows: below it currents are beyond all sense, and in the end beyond all numbers [V]."""
EDGE = 1e-12
"""How far beyond the edge of a piece, of its voltage, a root may lie for rounding [1]."""


@njit(cache=True)
def solve_bus(
    source: float, resistance: float, power: float, conductance: float, current: float
) -> tuple[float, float]:
    """Bus voltage [V] and the part of `power` that is served [1], less than 1 in a brown-out.

    Args:
        source, resistance: of all stores together [V], [ohm].
        power: constant power asked, negative when returned [W].
        conductance: of the resistive loads, not negative [S].
        current: drawn whatever the voltage [A].
    """
    lifted = source - resistance * current
    factor = 1.0 + resistance * conductance
    if lifted <= LEAST_VOLTAGE and power >= 0.0:  # power that is returned lifts even a bus without a force
        return 0.0, 0.0 if power > 0.0 else 1.0
    discriminant = lifted * lifted - 4.0 * factor * resistance * power
    if discriminant < 0.0:
        return 0.5 * lifted / factor, 0.25 * lifted * lifted / (factor * resistance * power)
    return 0.5 * (lifted + np.sqrt(discriminant)) / factor, 1.0


@njit(cache=True)
def store_current(store: FloatArray, voltage: float) -> float:
    """Out of a store of row (6,) at a bus voltage [A]."""
    current = min((store[FORCE] - voltage) / store[RESISTANCE], store[MOST])
    return current if (store[DISCHARGES] if current > 0.0 else store[CHARGES]) > 0.0 else 0.0


@njit(cache=True)
def floating_voltage(stores: FloatArray, sources: FloatArray, power: float, conductance: float) -> tuple[float, float]:
    """Voltage [V] of a bus that nothing holds, and the constant power that its loads get, net [W].

    Args:
        stores: (n, 6). sources: (m, 2), all give what they can. power: asked, net [W]. conductance: [S].
    """
    edges = np.empty(2 * stores.shape[0] + sources.shape[0])
    count = 0
    for store in stores:
        if store[CHARGES] != store[DISCHARGES]:
            edges[count] = store[FORCE]
            count += 1
        limited = store[FORCE] - store[RESISTANCE] * store[MOST]
        if limited > 0.0:
            edges[count] = limited
            count += 1
    for source in sources:
        if source[POWER] > 0.0 and np.isfinite(source[CURRENT]):
            edges[count] = source[POWER] / source[CURRENT]
            count += 1
    edges = np.sort(edges[:count])
    top, best_voltage, best_power = np.inf, 0.0, -np.inf
    for k in range(count + 1):
        low = edges[count - 1 - k] if k < count else 0.0
        inside = 0.5 * (low + top) if np.isfinite(top) else low + 1.0
        force, resistance, given, current = _together(stores, sources, inside)
        voltage, got = _in_piece(force, resistance, power - given, conductance, current)
        if got >= power - given and low - EDGE * low <= voltage <= top + EDGE * top:
            return voltage, power
        if count > 0:
            peak = min(max(_peak(force, resistance, conductance, current), low), top)
            got = peak * (current - conductance * peak)
            got += peak * (force - peak) / resistance if resistance > 0.0 else 0.0
            voltage = peak
        if got + given > best_power:
            best_voltage, best_power = voltage, got + given
        top = low
    return best_voltage, min(best_power, power)


@njit(cache=True)
def _together(stores: FloatArray, sources: FloatArray, voltage: float) -> tuple[float, float, float, float]:
    """Around a voltage: force [V] and resistance [ohm] of all stores that follow it, 0 without one; power [W] and
    current [A] of the sources, to which those stores belong that limit their current.
    """
    force, resistance, conductance, short, active = 0.0, 0.0, 0.0, 0.0, 0
    power, current = 0.0, 0.0
    for store in stores:
        if (store[DISCHARGES] if store[FORCE] > voltage else store[CHARGES]) > 0.0:
            if store[FORCE] - voltage > store[RESISTANCE] * store[MOST]:
                current += store[MOST]
                continue
            active += 1
            force, resistance = store[FORCE], store[RESISTANCE]
            conductance += 1.0 / resistance
            short += force / resistance
    if active > 1:
        force, resistance = short / conductance, 1.0 / conductance
    for source in sources:
        if source[CURRENT] * voltage < source[POWER]:
            current += source[CURRENT]
        else:
            power += source[POWER]
    return force, resistance, power, current


@njit(cache=True)
def _in_piece(force: float, resistance: float, power: float, conductance: float, current: float) -> tuple[float, float]:
    """Upper root [V] and the power that is got [W] of one piece, as if it had no edges; `current` comes in."""
    if resistance > 0.0:
        voltage, served = solve_bus(force, resistance, power, conductance, -current)
        return voltage, power * served if served < 1.0 else power
    if conductance > 0.0:
        inside = current * current - 4.0 * conductance * power
        if inside >= 0.0:
            return 0.5 * (current + np.sqrt(inside)) / conductance, power
        return 0.5 * current / conductance, 0.25 * current * current / conductance
    if power <= 0.0:
        return 0.0, power
    return (power / current, power) if current > 0.0 else (0.0, 0.0)


@njit(cache=True)
def _peak(force: float, resistance: float, conductance: float, current: float) -> float:
    """Voltage of most power of one piece [V]."""
    if resistance > 0.0:
        return 0.5 * (force + resistance * current) / (1.0 + resistance * conductance)
    return 0.5 * current / conductance if conductance > 0.0 else np.inf if current > 0.0 else 0.0


@njit(cache=True)
def _meet(
    stores: FloatArray,
    sources: FloatArray,
    converter: FloatArray,
    target: float,
    power: float,
    conductance: float,
    given: FloatArray,
) -> tuple[float, float, float, float]:
    """Voltage [V], constant power got [W], power from the converter and into the shunt [W].

    Args:
        converter: most and least power that it can give (2,) [W]. target: voltage to hold, infinite where none is [V].
        given: filled with the power of each source (m,) [W].
    """
    most, least = float(converter[0]), float(converter[1])
    takes, highest = False, 0.0
    for store in stores:
        highest = max(highest, store[FORCE])
        if store[CHARGES] > 0.0:
            takes, target = True, min(target, store[CEILING])
    if takes and (not np.isfinite(target) or (sources.shape[0] == 0 and most == 0.0 and least == 0.0)):
        voltage, got, fed, shunt = _afloat(stores, sources, most, power, conductance, given)
        return voltage, got, fed, shunt
    if not np.isfinite(target):
        target = highest
    needed, offered = power + conductance * target * target, most
    for store in stores:
        needed -= target * store_current(store, target)
    for source in sources:
        offered += min(source[POWER], source[CURRENT] * target)
    if needed <= 0.0:
        back = max(needed, least)
        if needed - back == 0.0:
            return target, power, back, 0.0
        top = max(target, highest)
        over = back - power - conductance * top * top
        if not takes and over >= 0.0:
            return top, power, back, over
        voltage, got = floating_voltage(stores, sources[:0], power - back, conductance)
        return voltage, power, back, 0.0
    if needed <= offered:
        left = needed
        for i in range(given.shape[0]):
            given[i] = min(left, sources[i, POWER], sources[i, CURRENT] * target)
            left -= given[i]
        return target, power, max(left, 0.0), 0.0
    if stores.shape[0] == 0:  # resistive loads go on, the others share the rest
        voltage, got = target, offered - conductance * target * target
        if got < min(power, 0.0):  # it does not even hold the voltage of the resistive ones
            got = min(power, 0.0)
            voltage, _ = floating_voltage(stores, sources, got - most, conductance)
        for i in range(given.shape[0]):
            given[i] = min(sources[i, POWER], sources[i, CURRENT] * voltage)
        return voltage, got, most, 0.0
    voltage, got, fed, shunt = _afloat(stores, sources, most, power, conductance, given)
    if voltage > target:  # the stores alone stand higher than what is held
        alone, got_alone = floating_voltage(stores, sources[:0], power, conductance)
        if got_alone >= power:
            given[:] = 0.0
            return alone, power, 0.0, 0.0
    return voltage, got, fed, shunt


@njit(cache=True)
def _afloat(
    stores: FloatArray, sources: FloatArray, fed: float, power: float, conductance: float, given: FloatArray
) -> tuple[float, float, float, float]:
    """As `_meet`, with all that sources and converter (`fed` [W]) can give, held by nothing."""
    voltage, got = floating_voltage(stores, sources, power - fed, conductance)
    for i in range(given.shape[0]):
        given[i] = min(sources[i, POWER], sources[i, CURRENT] * voltage)
    return voltage, got + fed if got < power - fed else power, fed, 0.0


@njit(cache=True)
def operating_point(
    loads: LoadColumns,
    switches: FloatArray,
    asked: FloatArray,
    locked_out: bool,
    drawn: FloatArray,
    stores: FloatArray,
    sources: FloatArray,
    converter: FloatArray,
    target: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Power [W] and current [A] of each load, and the flows of the bus: `FLOWS` numbers, the current of each store [A],
    the power of each source [W].

    Args:
        switches: 0 off to 1 on (loads,). asked: power of commanded loads (loads,) [W]. drawn: power at the inputs of
            converters that this bus feeds (n,), negative where they give back [W]. Others as in `_meet`.
    """
    rated, count = loads.rated, loads.rated.shape[0]
    power, conductances = np.zeros(count), np.zeros(count)
    flows = np.zeros(FLOWS + stores.shape[0] + sources.shape[0])
    currents, given = flows[FLOWS : FLOWS + stores.shape[0]], flows[FLOWS + stores.shape[0] :]
    for i in range(count):
        on = 0.0 if locked_out and not loads.essential[i] else switches[i]
        if on <= 0.0:  # takes nothing, and gives nothing back either
            continue
        if loads.resistive[i]:
            conductances[i] = on * rated[i] / loads.nominal_squared[i]
        else:
            power[i] = min(asked[i], on * rated[i]) if loads.commanded[i] else on * rated[i]
    wanted = power.sum() + drawn.sum()
    voltage, got, fed, shunt = _meet(stores, sources, converter, target, wanted, conductances.sum(), given)
    flows[VOLTAGE] = voltage
    if voltage <= LEAST_VOLTAGE:  # and nothing flows, whoever gives back: what asks for something gets none of it
        given[:] = 0.0
        flows[SERVED] = 0.0 if np.any(power > 0.0) or np.any(drawn > 0.0) else 1.0
        return np.zeros(count), np.zeros(count), flows
    served = 1.0
    if got < wanted:
        served = got / wanted
        # What motors return goes to the others whole; only what is asked is cut.
        asked_power = np.maximum(power, 0.0).sum() + np.maximum(drawn, 0.0).sum()
        returned = asked_power - wanted
        served = (served * (asked_power - returned) + returned) / asked_power
    for i in range(count):
        if power[i] > 0.0:
            power[i] *= served
        power[i] += conductances[i] * voltage**2
        flows[USED] += power[i]
    for each in drawn:
        flows[DRAWN] += each * served if each > 0.0 else each
    for k in range(currents.shape[0]):
        currents[k] = store_current(stores[k], voltage)
    flows[SERVED], flows[FED], flows[SHUNT] = served, fed, shunt
    return power, power / voltage, flows
