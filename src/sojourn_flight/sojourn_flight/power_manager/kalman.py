"""The charge of one store by an extended Kalman filter, with the deviation of its error.

State: charge z, polarisation voltage u, offset b of the current sensor, inverse capacity g (nominal over true), offset
c of the voltage sensor, and error e of the open-circuit voltage, a first-order Markov process over the charge moved:

    z <- z - eta g (I - b) dt / Q
    u <- a u + Rp (1 - a) (I - b)          a = exp(-dt / tau)
    e <- e exp(-|I| dt / (Q z_e))          e is a function of the charge: at rest it stays, however long that lasts
    V  = OCV(z) - u - R0 (I - b) + c + e + v

c and e are considered and not estimated: their gain is nothing, their mean stays nothing, and their covariance with
the others is kept. So what they leave open stays open: estimated, they seemed to be told apart from the charge wherever
the slope of OCV changes, which it does in the filter before it does in the cell. A charge that would leave 0 to 1 stays
there, and tells nothing of current offset and capacity.

Sources: Plett 2004, "Extended Kalman filtering for battery management systems of LiPB-based HEV battery packs", J.
Power Sources 134, parts 2 and 3; Plett 2015, "Battery Management Systems", vol. 2, ch. 3 and 4 (capacity). Considered
states: Schmidt 1966, "Application of state-space methods to navigation problems", Advances in Control Systems 3:293.
Update in Joseph's form, which holds for any gain.

Range: R0 and Rp are believed within `resistance_sigma`, the open-circuit voltage within `curve_error`; a charge that
the voltage does not tell (a flat curve) stays as uncertain as counting leaves it, and the deviation says so.
"""

from dataclasses import dataclass
from math import exp, sqrt

import numpy as np
from pydantic import Field

from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.power.stores import StoreParams

CHARGE, POLARISATION, CURRENT_OFFSET, INVERSE_CAPACITY, VOLTAGE_OFFSET, CURVE_ERROR = range(6)
STATES = 6
CONSIDERED = [VOLTAGE_OFFSET, CURVE_ERROR]
"""States without a gain."""
OF_COUNTING = [CURRENT_OFFSET, INVERSE_CAPACITY]
"""States that the counted charge depends on."""
MOST_OFF = 4.0
"""Factor by which a capacity may differ from the nominal one [1]."""
SLOPE_STEP = 0.01
"""Over which the slope of the open-circuit voltage is taken [1]."""


class KalmanParams(Params):
    """Deviations that the filter believes; those of the sensors are one step of 12-bit converters."""

    voltage_noise: float = Field(default=0.0105, gt=0.0, le=10.0, description="of a reading [V]")
    current_noise: float = Field(default=0.021, gt=0.0, le=100.0, description="of a reading [A]")
    voltage_offset: float = Field(default=0.02, gt=0.0, le=10.0, description="of the voltage sensor [V]")
    curve_error: float = Field(default=0.022, gt=0.0, le=10.0, description="of the open-circuit voltage [V]")
    curve_span: float = Field(default=0.1, gt=0.0, le=1.0, description="of charge, over which that changes [1]")
    current_offset: float = Field(default=0.01, gt=0.0, le=100.0, description="of the current sensor [A]")
    capacity_sigma: float = Field(default=0.1, gt=0.0, le=0.5, description="of the capacity, of the nominal [1]")
    resistance_sigma: float = Field(default=0.02, ge=0.0, le=1.0, description="of the resistances, of the believed [1]")
    charge_sigma: float = Field(default=0.05, gt=0.0, le=1.0, description="of a charge by the first voltage [1]")


@dataclass(frozen=True, eq=False, slots=True)
class KalmanState:
    """Mean (6,) and covariance (6, 6), in the order of the names above."""

    mean: FloatArray
    covariance: FloatArray

    @property
    def soc(self) -> float:
        """Charge [1]."""
        return min(max(float(self.mean[CHARGE]), 0.0), 1.0)

    @property
    def sigma(self) -> float:
        """Standard deviation of the charge [1]."""
        return sqrt(self.covariance[CHARGE, CHARGE])

    @property
    def capacity_factor(self) -> float:
        """Capacity of the nominal [1]."""
        return 1.0 / float(self.mean[INVERSE_CAPACITY])

    @property
    def capacity_sigma(self) -> float:
        """Its standard deviation [1]."""
        return sqrt(self.covariance[INVERSE_CAPACITY, INVERSE_CAPACITY]) * self.capacity_factor**2

    @property
    def current_offset(self) -> float:
        """Of the current sensor [A]."""
        return float(self.mean[CURRENT_OFFSET])


def initial_state(
    params: KalmanParams, store: StoreParams, reading: StoreReading, soc: float | None = None
) -> KalmanState:
    """From the first reading; a charge that is known is taken for as uncertain as one by the voltage."""
    polarisation, _ = store.polarisation(reading.temperature)
    ohmic = store.settled_resistance(reading.temperature) - polarisation
    half = 0.5 * polarisation * reading.current
    if soc is None:
        soc = store.soc_from_open_circuit_voltage(reading.voltage + ohmic * reading.current + half)
    deviations = (
        params.charge_sigma,
        abs(half) + params.voltage_noise,
        params.current_offset,
        params.capacity_sigma,
        params.voltage_offset,
        params.curve_error,
    )
    return KalmanState(np.array([soc, half, 0.0, 1.0, 0.0, 0.0]), np.diag(np.square(deviations)))


def step(params: KalmanParams, store: StoreParams, state: KalmanState, reading: StoreReading, dt: float) -> KalmanState:
    """The estimate after a reading that is in order, `dt` [s] after the last."""
    resistance, time_constant = store.polarisation(reading.temperature)
    ohmic = store.settled_resistance(reading.temperature) - resistance
    mean, covariance = _predicted(params, store, state, reading, dt, resistance, time_constant)
    charge, current = float(mean[CHARGE]), reading.current - float(mean[CURRENT_OFFSET])
    expected = store.open_circuit_voltage(charge) - float(mean[POLARISATION]) - ohmic * current
    seen = np.array([_slope(store, charge), -1.0, ohmic, 0.0, 1.0, 1.0])
    noise = params.voltage_noise**2 + (params.resistance_sigma * ohmic * current) ** 2
    spread = covariance @ seen
    gain = spread / (float(seen @ spread) + noise)
    gain[CONSIDERED] = 0.0
    told = reading.voltage - expected
    if not 0.0 <= mean[CHARGE] + gain[CHARGE] * told <= 1.0:
        gain[OF_COUNTING] = 0.0
    kept = np.eye(STATES) - np.outer(gain, seen)
    after = mean + gain * told
    covariance = kept @ covariance @ kept.T + noise * np.outer(gain, gain)
    after[CHARGE] = min(max(after[CHARGE], 0.0), 1.0)
    after[INVERSE_CAPACITY] = min(max(after[INVERSE_CAPACITY], 1.0 / MOST_OFF), MOST_OFF)
    return KalmanState(after, covariance)


def _slope(store: StoreParams, charge: float) -> float:
    """Of the open-circuit voltage over the charge [V]."""
    low, high = max(charge - SLOPE_STEP, 0.0), min(charge + SLOPE_STEP, 1.0)
    return (store.open_circuit_voltage(high) - store.open_circuit_voltage(low)) / (high - low)


def _predicted(
    params: KalmanParams,
    store: StoreParams,
    state: KalmanState,
    reading: StoreReading,
    dt: float,
    resistance: float,
    time_constant: float,
) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance before the voltage is looked at."""
    efficiency = store.charging_efficiency if reading.current < 0.0 else 1.0
    part = efficiency * dt / store.charge_capacity
    decay = exp(-dt / time_constant) if time_constant > 0.0 else 0.0
    fade = exp(-part * abs(reading.current) / params.curve_span)
    mean = state.mean.copy()
    current, inverse = reading.current - float(mean[CURRENT_OFFSET]), float(mean[INVERSE_CAPACITY])
    change = np.eye(STATES)
    counted = float(mean[CHARGE]) - part * inverse * current
    if 0.0 <= counted <= 1.0:
        change[CHARGE, CURRENT_OFFSET] = part * inverse
        change[CHARGE, INVERSE_CAPACITY] = -part * current
    change[POLARISATION, POLARISATION] = decay
    change[POLARISATION, CURRENT_OFFSET] = -resistance * (1.0 - decay)
    change[CURVE_ERROR, CURVE_ERROR] = fade
    mean[CHARGE] = min(max(counted, 0.0), 1.0)
    mean[POLARISATION] = decay * mean[POLARISATION] + resistance * (1.0 - decay) * current
    covariance = change @ state.covariance @ change.T
    covariance[CHARGE, CHARGE] += (part * params.current_noise) ** 2
    model = params.resistance_sigma * resistance * current
    covariance[POLARISATION, POLARISATION] += (1.0 - decay**2) * (model**2 + params.voltage_noise**2)
    covariance[CURVE_ERROR, CURVE_ERROR] += (1.0 - fade**2) * params.curve_error**2
    return mean, covariance
