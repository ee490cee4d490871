"""The charge of one store by an extended Kalman filter, with the deviation of its error.

State: charge z, polarisation voltage u, offset b of the current sensor, inverse capacity g (nominal over true), offset
c of the voltage (of the sensor, and slow errors of the model), a first-order Markov process:

    z <- z - eta g (I - b) dt / Q
    u <- a u + Rp (1 - a) (I - b)          a = exp(-dt / tau)
    c <- c exp(-dt / tau_c)
    V  = OCV(z) - u - R0 (I - b) + c + v

Sources: Plett 2004, "Extended Kalman filtering for battery management systems of LiPB-based HEV battery packs", J.
Power Sources 134, parts 2 and 3; Plett 2015, "Battery Management Systems", vol. 2, ch. 3 and 4 (capacity). Update in
Joseph's form.

Range: R0 and Rp are believed within `resistance_sigma`, the open-circuit voltage within `voltage_offset`; a charge that
the voltage does not tell (a flat curve) stays as uncertain as counting leaves it, and the deviation says so.
"""

from dataclasses import dataclass
from math import exp, sqrt

import numpy as np
from pydantic import Field

from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.power.stores import StoreParams

CHARGE, POLARISATION, CURRENT_OFFSET, INVERSE_CAPACITY, VOLTAGE_OFFSET = range(5)
STATES = 5
MOST_OFF = 4.0
"""Factor by which a capacity may differ from the nominal one [1]."""
SLOPE_STEP = 0.01
"""Over which the slope of the open-circuit voltage is taken [1]."""


class KalmanParams(Params):
    """Deviations that the filter believes; those of the sensors are one step of 12-bit converters."""

    voltage_noise: float = Field(default=0.0105, gt=0.0, le=10.0, description="of a reading [V]")
    current_noise: float = Field(default=0.021, gt=0.0, le=100.0, description="of a reading [A]")
    voltage_offset: float = Field(default=0.03, gt=0.0, le=10.0, description="of sensor and open-circuit voltage [V]")
    offset_time: float = Field(default=3600.0, gt=0.0, le=1e7, description="in which that changes [s]")
    current_offset: float = Field(default=0.01, gt=0.0, le=100.0, description="of the current sensor [A]")
    capacity_sigma: float = Field(default=0.1, gt=0.0, le=0.5, description="of the capacity, of the nominal [1]")
    resistance_sigma: float = Field(default=0.02, ge=0.0, le=1.0, description="of the resistances, of the believed [1]")
    charge_sigma: float = Field(default=0.05, gt=0.0, le=1.0, description="of a charge by the first voltage [1]")


@dataclass(frozen=True, eq=False, slots=True)
class KalmanState:
    """Mean (5,) and covariance (5, 5), in the order of the names above."""

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
    )
    return KalmanState(np.array([soc, half, 0.0, 1.0, 0.0]), np.diag(np.square(deviations)))


def step(params: KalmanParams, store: StoreParams, state: KalmanState, reading: StoreReading, dt: float) -> KalmanState:
    """The estimate after a reading that is in order, `dt` [s] after the last."""
    resistance, time_constant = store.polarisation(reading.temperature)
    ohmic = store.settled_resistance(reading.temperature) - resistance
    mean, covariance = _predicted(params, store, state, reading, dt, resistance, time_constant)
    charge, current = float(mean[CHARGE]), reading.current - float(mean[CURRENT_OFFSET])
    low, high = max(charge - SLOPE_STEP, 0.0), min(charge + SLOPE_STEP, 1.0)
    slope = (store.open_circuit_voltage(high) - store.open_circuit_voltage(low)) / (high - low) if high > low else 0.0
    expected = (
        store.open_circuit_voltage(charge) - float(mean[POLARISATION]) - ohmic * current + float(mean[VOLTAGE_OFFSET])
    )
    seen = np.array([slope, -1.0, ohmic, 0.0, 1.0])
    noise = params.voltage_noise**2 + (params.resistance_sigma * ohmic * current) ** 2
    spread = covariance @ seen
    gain = spread / (float(seen @ spread) + noise)
    kept = np.eye(STATES) - np.outer(gain, seen)
    after = mean + gain * (reading.voltage - expected)
    after[CHARGE] = min(max(after[CHARGE], 0.0), 1.0)
    after[INVERSE_CAPACITY] = min(max(after[INVERSE_CAPACITY], 1.0 / MOST_OFF), MOST_OFF)
    return KalmanState(after, kept @ covariance @ kept.T + noise * np.outer(gain, gain))


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
    fade = exp(-dt / params.offset_time)
    mean = state.mean.copy()
    current, inverse = reading.current - float(mean[CURRENT_OFFSET]), float(mean[INVERSE_CAPACITY])
    change = np.eye(STATES)
    change[CHARGE, CURRENT_OFFSET] = part * inverse
    change[CHARGE, INVERSE_CAPACITY] = -part * current
    change[POLARISATION, POLARISATION] = decay
    change[POLARISATION, CURRENT_OFFSET] = -resistance * (1.0 - decay)
    change[VOLTAGE_OFFSET, VOLTAGE_OFFSET] = fade
    mean[CHARGE] -= part * inverse * current
    mean[POLARISATION] = decay * mean[POLARISATION] + resistance * (1.0 - decay) * current
    mean[VOLTAGE_OFFSET] *= fade
    covariance = change @ state.covariance @ change.T
    covariance[CHARGE, CHARGE] += (part * params.current_noise) ** 2
    model = params.resistance_sigma * resistance * current
    covariance[POLARISATION, POLARISATION] += (1.0 - decay**2) * (model**2 + params.voltage_noise**2)
    covariance[VOLTAGE_OFFSET, VOLTAGE_OFFSET] += (1.0 - fade**2) * params.voltage_offset**2
    return mean, covariance
