"""The charge of one store, estimated from its telemetry.

Coulomb counting of the measured current, corrected by the open-circuit voltage while the machine rests:

    soc <- soc - eta I dt / Q
    soc <- soc + (OCV^-1(V + R I) - soc) (1 - exp(-dt / tau_c))   after |I| <= I_rest for long enough

(Plett 2015, "Battery Management Systems", vol. 2, ch. 3). V and I are low-pass filtered for the correction; after the
rest time the polarisation has settled, so that R, polarisation included, needs no model in time.

Range: steps shorter than the filters' time constants; temperature within the tables of the store.
"""

from dataclasses import dataclass
from math import exp

from sojourn_flight.power_manager import kalman
from sojourn_flight.power_manager.kalman import KalmanState
from sojourn_flight.power_manager.params import PowerLawParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.evolution import replace
from sojourn_machine.power.stores import StoreParams


@dataclass(frozen=True, slots=True)
class StoreEstimate:
    """What is known of one store."""

    soc: float | None
    """Estimated charge [1]; None until the first telemetry gives it from the voltage."""
    voltage_filtered: float | None = None
    """Low-passed voltage [V]."""
    current_filtered: float = 0.0
    """Low-passed current [A]."""
    rest_elapsed: float = 0.0
    """Time at rest [s]."""
    correcting: bool = False
    """The open-circuit voltage is correcting the charge."""
    filter: KalmanState | None = None
    """Where the law estimates by one; None until the first telemetry."""

    @property
    def charge(self) -> float:
        """State of charge as far as it is known [1]."""
        return 0.0 if self.soc is None else self.soc


def step(
    store: StoreParams, law: PowerLawParams, before: StoreEstimate, reading: StoreReading, dt: float
) -> StoreEstimate:
    """The estimate after a period of `dt` [s] with a reading that is in order."""
    state = _filtered(law, before, reading, dt)
    if law.estimator == "kalman":
        known = before.filter
        if known is None:
            known = kalman.initial_state(law.kalman, store, reading, before.soc)
        else:
            known = kalman.step(law.kalman, store, known, reading, dt)
        return replace(state, soc=known.soc, filter=known)
    if state.soc is None:
        return replace(state, soc=_soc_by_voltage(store, state, reading))

    efficiency = store.charging_efficiency if reading.current < 0.0 else 1.0
    soc = state.soc - efficiency * reading.current * dt / store.charge_capacity
    rest_elapsed = state.rest_elapsed + dt if abs(reading.current) <= law.rest_current else 0.0
    correcting = rest_elapsed > law.rest_time
    if correcting:
        soc += (_soc_by_voltage(store, state, reading) - soc) * (1.0 - exp(-dt / law.correction_time_constant))
    return replace(state, soc=min(max(soc, 0.0), 1.0), rest_elapsed=rest_elapsed, correcting=correcting)


def _soc_by_voltage(store: StoreParams, state: StoreEstimate, reading: StoreReading) -> float:
    """State of charge of a rested store that shows what is filtered [1]."""
    voltage = reading.voltage if state.voltage_filtered is None else state.voltage_filtered
    rested = voltage + store.settled_resistance(reading.temperature) * state.current_filtered
    return store.soc_from_open_circuit_voltage(rested)


def _filtered(law: PowerLawParams, state: StoreEstimate, reading: StoreReading, dt: float) -> StoreEstimate:
    if state.voltage_filtered is None:
        return replace(state, voltage_filtered=reading.voltage, current_filtered=reading.current)
    gain = 1.0 - exp(-dt / law.filter_time_constant)
    return replace(
        state,
        voltage_filtered=state.voltage_filtered + gain * (reading.voltage - state.voltage_filtered),
        current_filtered=state.current_filtered + gain * (reading.current - state.current_filtered),
    )
