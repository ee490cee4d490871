"""A flywheel with a permanent-magnet motor and generator: energy of a spinning rotor.

Equations, speed w, current I out positive, constant k of the machine:

    J dw/dt = -k I - Tc - b w            Tc: constant friction; b: eddy currents, rest of air
    V       = k w - R I                  electromotive force k w behind the resistance R
    soc     = (w - w0) / (w1 - w0)       charge above the empty speed w0 over J (w1 - w0) / k, w1: full speed

so to its bus it is a capacitor of J / k^2 farad. The equation of the speed is linear and solved exactly for a current
constant over a step, with x = b dt / J, p1 = (1 - e^-x) / x and p2 = (1 - p1) / x:

    w(dt)      = w e^-x - (k I + Tc) dt / J p1             angle turned = w dt p1 - (k I + Tc) dt^2 / J p2

A rotor that comes to rest within a step stays there. The energy balance of a step is exact: J w^2 / 2 given =
terminal energy + R I^2 dt + friction, the first from k I times the angle turned.

Sources: Hanselman 2006, "Brushless Permanent Magnet Motor Design" (one constant for voltage and torque); Genta 1985,
"Kinetic Energy Storage" (losses of a flywheel). Rectifier and inverter are taken as without loss; a converter between
buses holds a voltage where that is wanted. Beyond its full speed it is not charged. Valid for currents that saturate no
iron. The reaction of the rotor on its machine is left out, as that of a pair which spins
against each other; `momentum` tells what one alone has. Temperature is that of the surroundings.
"""

from dataclasses import dataclass
from math import exp, expm1, isfinite, log1p
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.flywheel_rotor import RotorParams
from sojourn_machine.power.stores import StoreParams, StorePoint

SERIES = 1e-2
"""Of x, below which p1 and p2 are taken from their series, whose rest is then below rounding [1]."""


@dataclass(frozen=True, slots=True)
class FlywheelState:
    """What a flywheel remembers. Energies are sums since `initial_state`."""

    soc: float
    """Speed above the empty one, of that of the full one; below 0 where friction has slowed it further [1]."""
    temperature: float
    """[K]"""
    energy_terminal: float = 0.0
    """Net energy through the terminals, out positive [J]."""
    energy_heat: float = 0.0
    """Released in resistance and friction [J]."""


class FlywheelParams(StoreParams):
    """One flywheel, or a pair as a whole."""

    kind: str = "flywheel"
    rotor: RotorParams = Field(description="what spins")
    speed_empty: float = Field(gt=0.0, le=1e5, description="below which it is not discharged [rad/s]")
    speed_full: float = Field(gt=0.0, le=1e5, description="to which it is charged [rad/s]")
    emf_constant: float = Field(gt=0.0, le=1e4, description="voltage over speed, torque over current [V s/rad]")
    resistance: float = Field(gt=0.0, le=100.0, description="of the windings, as the bus sees it [ohm]")
    friction_torque: float = Field(ge=0.0, le=1e4, description="at any speed [N m]")
    viscous_friction: float = Field(ge=0.0, le=1e3, description="torque over speed [N m s/rad]")
    current_limit: float = Field(gt=0.0, le=1e5, description="largest current either way [A]")
    temperature_surroundings: float = Field(gt=20.0, lt=1000.0, description="temperature of its surroundings [K]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.speed_full <= self.speed_empty:
            raise InvalidValueError("speed_full", self.speed_full, f"above speed_empty, {self.speed_empty} rad/s")
        most = self.rotor.allowed_speed
        if self.speed_full > most:
            allowed = f"at most {most:.6g} rad/s, at which the rotor's stress is its strength over its safety factor"
            raise InvalidValueError("speed_full", self.speed_full, allowed)
        return self

    @property
    def charge_capacity(self) -> float:
        """Charge between full and empty [C]."""
        return self.rotor.inertia * (self.speed_full - self.speed_empty) / self.emf_constant

    def speed(self, soc: float) -> float:
        """At a state of charge [rad/s]."""
        return self.speed_empty + soc * (self.speed_full - self.speed_empty)

    def momentum(self, state: FlywheelState) -> float:
        """Angular momentum of one rotor [N m s]."""
        return self.rotor.inertia * self.speed(state.soc)

    def initial_state(self, soc: float, temperature: float | None = None) -> FlywheelState:
        """See `StoreParams`."""
        if not 0.0 <= soc <= 1.0:
            raise InvalidValueError("state of charge of the flywheel", soc, "0 to 1")
        start = self.temperature_surroundings if temperature is None else temperature
        if not (isfinite(start) and start > 0.0):
            raise InvalidValueError("temperature of the flywheel [K]", start, "a finite number above 0")
        return FlywheelState(float(soc), float(start))

    def point(self, state: FlywheelState) -> StorePoint:
        """See `StoreParams`."""
        force = self.open_circuit_voltage(state.soc)
        full = self.open_circuit_voltage(1.0)
        ceiling = min(full, force + self.resistance * self.current_limit)
        return StorePoint(force, self.resistance, ceiling, state.soc > 0.0, state.soc < 1.0)

    def step(
        self, state: FlywheelState, current: float, dt: float, temperature_surroundings: float | None = None
    ) -> FlywheelState:
        """See `StoreParams`."""
        if not isfinite(current):
            raise InvalidValueError("current of the flywheel [A]", current, "a finite number")
        if not (isfinite(dt) and dt > 0.0):
            raise InvalidValueError("dt [s]", dt, "a finite number above 0")
        around = self.temperature_surroundings if temperature_surroundings is None else temperature_surroundings
        if not (isfinite(around) and around > 0.0):
            raise InvalidValueError("temperature of the flywheel [K]", around, "a finite number above 0")
        inertia, before = self.rotor.inertia, self.speed(state.soc)
        after, angle = self._turned(before, current, dt)
        given = 0.5 * inertia * (before - after) * (before + after)
        converted = self.emf_constant * current * angle
        ohmic = self.resistance * current * current * dt
        return replace(
            state,
            soc=(after - self.speed_empty) / (self.speed_full - self.speed_empty),
            temperature=around,
            energy_terminal=state.energy_terminal + converted - ohmic,
            energy_heat=state.energy_heat + ohmic + given - converted,
        )

    def _turned(self, speed: float, current: float, dt: float) -> tuple[float, float]:
        """Speed after `dt` [rad/s] and the angle turned until then [rad]."""
        inertia, viscous = self.rotor.inertia, self.viscous_friction
        torque = self.emf_constant * current + self.friction_torque
        if speed <= 0.0:
            torque = min(torque, 0.0)  # friction holds it until the motor is stronger
        stops, duration = False, dt
        if torque > 0.0:
            rest = _time_to_rest(inertia, speed, torque, viscous)
            stops, duration = rest <= dt, min(rest, dt)
        p1, p2 = means_over_step(viscous * duration / inertia)
        angle = speed * duration * p1 - torque * duration**2 / inertia * p2
        after = 0.0 if stops else speed * exp(-viscous * duration / inertia) - torque * duration / inertia * p1
        return after, angle

    def heat_given(self, before: FlywheelState, after: FlywheelState) -> float:
        """All that was released: its temperature is that of its surroundings [J]."""
        return float(after.energy_heat - before.energy_heat)

    def stored_energy(self, soc: float) -> float:
        """Energy above empty at a state of charge [J]."""
        return 0.5 * self.rotor.inertia * (self.speed(soc) ** 2 - self.speed_empty**2)

    def open_circuit_voltage(self, soc: float) -> float:
        """Of the rotor that spins freely [V]."""
        return self.emf_constant * self.speed(soc)

    def soc_from_open_circuit_voltage(self, voltage: float) -> float:
        """State of charge [0..1] of a flywheel without current."""
        soc = (voltage / self.emf_constant - self.speed_empty) / (self.speed_full - self.speed_empty)
        return min(max(soc, 0.0), 1.0)

    def settled_resistance(self, temperature: float) -> float:
        """Its resistance, at any temperature [ohm]."""
        return self.resistance

    def limits_exceeded(self, temperature: float, current: float) -> tuple[str, ...]:
        """Which limits a current [A, out positive] breaks, in words."""
        return ("current above the limit",) if abs(current) > self.current_limit else ()


def _time_to_rest(inertia: float, speed: float, torque: float, viscous: float) -> float:
    """Of a rotor that a constant torque above 0 [N m] and a viscous one slow [s]; infinite beyond all numbers."""
    ratio = viscous * speed / torque
    if ratio > 1.0:
        return inertia / viscous * log1p(ratio)
    return inertia * (speed / torque) * (log1p(ratio) / ratio if ratio > 0.0 else 1.0)


def means_over_step(x: float) -> tuple[float, float]:
    """p1 and p2 of the equations, 1 and 1/2 where x is 0."""
    if x > SERIES:
        p1 = -expm1(-x) / x
        return p1, (1.0 - p1) / x
    p2 = 0.5 - x / 6.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0))))
    return 1.0 - x * p2, p2
