"""A bank of double-layer capacitors: a capacitance behind a resistance, with a leak.

Equations of a bank of capacitance C between an empty voltage V0 and a full voltage V1, current I out positive:

    dE/dt = -I / C - E / (R_leak C)      electromotive force E; the leak acts along a period at the force of its start
    V     = E - R I
    soc   = (E - V0) / (V1 - V0)         charge above empty over C (V1 - V0)

The energy balance of a step is exact: C (E0^2 - E^2) / 2 = terminal energy + R I^2 dt + leak, with the force linear
in time.

Source: classical equivalent circuit (Zubieta and Bonert 2000, "Characterization of double-layer capacitors for power
electronics applications", IEEE Transactions on Industry Applications 36-1), with its first branch alone; the slow
branches, which take a few per cent of the charge within minutes, and the growth of C with the voltage are left out.
Valid for steps short against the leak's time constant. Temperature is that of the surroundings.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.stores import StoreParams, StorePoint


@dataclass(frozen=True, slots=True)
class CapacitorState:
    """What a bank remembers. Energies are sums since `initial_state`."""

    soc: float
    """Charge above the empty voltage, of that of the full one [1]."""
    temperature: float
    """[K]"""
    energy_terminal: float = 0.0
    """Net energy through the terminals, out positive [J]."""
    energy_heat: float = 0.0
    """Released in resistance and leak [J]."""


class SupercapacitorParams(StoreParams):
    """A bank, as a whole."""

    kind: str = "supercapacitor"
    capacitance: float = Field(gt=0.0, le=1e6, description="of the bank [F]")
    resistance: float = Field(gt=0.0, le=100.0, description="in series [ohm]")
    leak_resistance: float = Field(gt=0.0, le=1e9, description="across the bank [ohm]")
    voltage_empty: float = Field(ge=0.0, le=1e4, description="below which it is not discharged [V]")
    voltage_full: float = Field(gt=0.0, le=1e4, description="to which it is charged [V]")
    current_limit: float = Field(gt=0.0, le=1e5, description="largest current either way [A]")
    temperature_surroundings: float = Field(gt=20.0, lt=1000.0, description="temperature of its surroundings [K]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.voltage_full <= self.voltage_empty:
            allowed = f"above voltage_empty, {self.voltage_empty} V"
            raise InvalidValueError("voltage_full", self.voltage_full, allowed)
        return self

    @property
    def charge_capacity(self) -> float:
        """Charge between full and empty [C]."""
        return self.capacitance * (self.voltage_full - self.voltage_empty)

    def initial_state(self, soc: float, temperature: float | None = None) -> CapacitorState:
        """See `StoreParams`."""
        if not 0.0 <= soc <= 1.0:
            raise InvalidValueError("state of charge of the capacitors", soc, "0 to 1")
        start = self.temperature_surroundings if temperature is None else temperature
        if not (isfinite(start) and start > 0.0):
            raise InvalidValueError("temperature of the capacitors [K]", start, "a finite number above 0")
        return CapacitorState(float(soc), float(start))

    def point(self, state: CapacitorState) -> StorePoint:
        """See `StoreParams`."""
        force = max(self.open_circuit_voltage(state.soc), 0.0)  # but for rounding it is not below
        ceiling = min(self.voltage_full, force + self.resistance * self.current_limit)
        return StorePoint(force, self.resistance, ceiling, state.soc > 0.0, True)

    def elastance(self, state: CapacitorState) -> float:
        """See `StoreParams`."""
        return 1.0 / self.capacitance

    def step(
        self, state: CapacitorState, current: float, dt: float, temperature_surroundings: float | None = None
    ) -> CapacitorState:
        """See `StoreParams`."""
        if not isfinite(current):
            raise InvalidValueError("current of the capacitors [A]", current, "a finite number")
        if not (isfinite(dt) and dt > 0.0):
            raise InvalidValueError("dt [s]", dt, "a finite number above 0")
        around = self.temperature_surroundings if temperature_surroundings is None else temperature_surroundings
        before = self.open_circuit_voltage(state.soc)
        left = max(self.capacitance * before / dt - max(current, 0.0), 0.0)
        leak = min(before / self.leak_resistance, left)  # a long step leaks no more than there is
        after = before - (current + leak) * dt / self.capacitance
        mean = 0.5 * (before + after)
        ohmic = self.resistance * current * current * dt
        return replace(
            state,
            soc=(after - self.voltage_empty) / (self.voltage_full - self.voltage_empty),
            temperature=around,
            energy_terminal=state.energy_terminal + mean * current * dt - ohmic,
            energy_heat=state.energy_heat + ohmic + mean * leak * dt,
        )

    def heat_given(self, before: CapacitorState, after: CapacitorState) -> float:
        """All that was released: its temperature is that of its surroundings [J]."""
        return float(after.energy_heat - before.energy_heat)

    def stored_energy(self, soc: float) -> float:
        """Energy above empty at a state of charge [J]."""
        return 0.5 * self.capacitance * (self.open_circuit_voltage(soc) ** 2 - self.voltage_empty**2)

    def open_circuit_voltage(self, soc: float) -> float:
        """Of the rested bank [V]."""
        return self.voltage_empty + soc * (self.voltage_full - self.voltage_empty)

    def soc_from_open_circuit_voltage(self, voltage: float) -> float:
        """State of charge [0..1] of a rested bank."""
        soc = (voltage - self.voltage_empty) / (self.voltage_full - self.voltage_empty)
        return min(max(soc, 0.0), 1.0)

    def settled_resistance(self, temperature: float) -> float:
        """Its resistance, at any temperature [ohm]."""
        return self.resistance

    def limits_exceeded(self, temperature: float, current: float) -> tuple[str, ...]:
        """Which limits a current [A, out positive] breaks, in words."""
        return ("current above the limit",) if abs(current) > self.current_limit else ()
