"""What a store of energy is to its network: an electromotive force behind a resistance, with a state of charge.

A kind of store is one module: parameters derived from `StoreParams`, a state with `soc` and `temperature`, equations
with their source. It is registered by an entry point of the group `sojourn.power_stores` under the name that a file
says as `kind`. Nothing else changes: network, plant, contract and power manager know only what is here.
"""

from math import inf
from typing import Any, NamedTuple, Protocol

from pydantic import Field

from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

MAIN = "main"
"""The bus on which a member is whose file names none."""
STORES: "Registry[type[StoreParams]]" = Registry("sojourn.power_stores", "kind of store")
"""Parameter sets of the kinds of stores, by their names."""
_SLOPE_STEP = 0.005
"""Of the state of charge, either way, over which the slope of the force is taken [1]."""
SHORT = 0.1
"""Period within which no force moves by what matters: a lone store keeps that of its start [s]."""
_TO_THE_LAST = 1.0 + 1e-12
"""That rounding leaves nothing in a store which a period empties [1]."""


class StoreState(Protocol):
    """What every store remembers, whatever else it does."""

    @property
    def soc(self) -> float:
        """State of charge [1]."""

    @property
    def temperature(self) -> float:
        """[K]"""


class StorePoint(NamedTuple):
    """A store as its bus sees it for a control period; a row of the kernel's table. The current out of it at a bus
    voltage V is (source - V) / resistance, at most `most`, unless it may not flow that way.
    """

    source: float
    """Electromotive force [V]."""
    resistance: float
    """In series, above 0 [ohm]."""
    ceiling: float
    """Bus voltage up to which sources and converters may charge it [V]; its own force where they may not at all."""
    discharges: bool
    """Current may flow out."""
    charges: bool
    """Current may flow in."""
    most: float = inf
    """Current out of it that it limits itself to [A]."""


class ForceCourse(NamedTuple):
    """What a steady current I meets in a period: force less resistance I, [V] and [ohm], of its mean and of its end."""

    mean_force: float
    mean_resistance: float
    end_force: float
    end_resistance: float


class StoreParams(Params):
    """One store. Each kind has a subclass with its parameters, whose default of `kind` is its name."""

    kind: str = Field(description="kind of store")
    bus: str = Field(default=MAIN, min_length=1, description="name of the bus that it is on")

    @property
    def charge_capacity(self) -> float:
        """Charge between full and empty [C]."""
        raise NotImplementedError

    @property
    def charging_efficiency(self) -> float:
        """Part of a charging current that is stored [1]."""
        return 1.0

    @property
    def strings(self) -> int:
        """Equal parts in parallel of which each may fail by itself [1]."""
        return 1

    def initial_state(self, soc: float, temperature: float | None = None) -> Any:
        """A rested store at a state of charge [0..1] and a temperature [K], by default its surroundings'.

        Raises:
            InvalidValueError: either out of range.
        """
        raise NotImplementedError

    def point(self, state: Any) -> StorePoint:
        """The store as its bus sees it for the next control period."""
        raise NotImplementedError

    def step(self, state: Any, current: float, dt: float, temperature_surroundings: float | None = None) -> Any:
        """The state after `current` [A, out of the store positive] has flowed for `dt` [s].

        Args:
            temperature_surroundings: [K], the value of the parameters unless given.

        Raises:
            InvalidValueError: a number that is not finite, dt not positive.
        """
        raise NotImplementedError

    def elastance(self, state: Any) -> float:
        """By how much its force falls with the charge out of it, where it is [V/C]."""
        middle = min(max(state.soc, _SLOPE_STEP), 1.0 - _SLOPE_STEP)
        rise = self.open_circuit_voltage(middle + _SLOPE_STEP) - self.open_circuit_voltage(middle - _SLOPE_STEP)
        return rise / (2.0 * _SLOPE_STEP * self.charge_capacity)

    def course(self, state: Any, point: StorePoint, dt: float) -> ForceCourse:
        """Over a period of `dt` [s] from a point on: the charge that flows out lowers the force by the elastance, which
        is so much more resistance.
        """
        fall = dt * self.elastance(state)
        return ForceCourse(point.source, point.resistance + 0.5 * fall, point.source, point.resistance + fall)

    def largest_charge(self, state: Any, point: StorePoint) -> float:
        """Current with which sources may charge it, whatever its voltage; not above 0 where they may not [A]."""
        return (point.ceiling - point.source) / point.resistance

    def emptying(self, state: Any, dt: float) -> float:
        """Current that takes all of its charge in `dt` [s] [A]."""
        return float(state.soc * self.charge_capacity / dt)

    def over(self, state: Any, dt: float, alone: bool) -> StorePoint:
        """As `point`, for a period of `dt` [s]: it gives no more than what is left, and sources charge it no further
        than to its ceiling at the end. `alone`: no other store is on its bus.

        A lone store has the mean force of the period, so that its bus sees the energy which it gives (exact for a force
        linear in the charge: the implicit midpoint rule). Stores on one bus level each other out, a small one beside a
        large one in less than a step of a forecast, which with any but the forces of the end would run away (implicit
        Euler).
        """
        point = self.point(state)
        most = min(point.most, self.emptying(state, dt) * _TO_THE_LAST) if state.soc > 0.0 else point.most
        if dt <= SHORT:
            more = 0.0 if alone else dt * self.elastance(state)
            return StorePoint(point.source, point.resistance + more, *point[2:5], most)
        course = self.course(state, point, dt)
        to_full = (self.full_voltage - course.end_force) / course.end_resistance
        room = (1.0 - state.soc) * self.charge_capacity / (self.charging_efficiency * dt)
        taken = max(min(self.largest_charge(state, point), to_full, room), 0.0)
        force, resistance = course[:2] if alone else course[2:]
        return StorePoint(force, resistance, force + resistance * taken, point.discharges, point.charges, most)

    @property
    def exchange(self) -> tuple[float, float]:
        """Conductance to its surroundings [W/K] and heat capacity [J/K]; zeros where it is as warm as they are."""
        return 0.0, 0.0

    def heat_given(self, before: Any, after: Any) -> float:
        """Heat that went into its surroundings between two of its states, 0 where the kind keeps no account [J]."""
        return 0.0

    def stored_energy(self, soc: float) -> float:
        """Energy above empty at a state of charge [J]."""
        raise NotImplementedError

    def open_circuit_voltage(self, soc: float) -> float:
        """Of the rested store at a state of charge [V]."""
        raise NotImplementedError

    @property
    def full_voltage(self) -> float:
        """Of the rested full store [V]."""
        return self.open_circuit_voltage(1.0)

    def soc_from_open_circuit_voltage(self, voltage: float) -> float:
        """State of charge [0..1] of a rested store whose terminals show `voltage` [V]."""
        raise NotImplementedError

    def settled_resistance(self, temperature: float) -> float:
        """What a steady current meets at a temperature [K], polarisation included [ohm]."""
        raise NotImplementedError

    def polarisation(self, temperature: float) -> tuple[float, float]:
        """The part of it that a current meets slowly [ohm], and its time constant [s]; zeros where there is none."""
        return 0.0, 0.0

    def limits_exceeded(self, temperature: float, current: float) -> tuple[str, ...]:
        """Which limits a temperature [K] and a current [A, out positive] break, in words."""
        return ()

    @property
    def most_power(self) -> float:
        """That a full store can give [W]: its force squared over four times its resistance."""
        point = self.point(self.initial_state(1.0))
        return point.source**2 / (4.0 * point.resistance)
