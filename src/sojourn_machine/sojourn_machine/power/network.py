"""The power network of a machine: stores, sources, converters and loads on buses, solved once for each control period.

The plant steps it as the truth; what the power manager believes is the same parameters. Each bus is solved by a
kernel (`bus_kernels`). Converters make a tree of the buses: a bus is solved before the one that feeds it, which so
knows what is drawn from it, and once more where that one cannot give all of it. With one bus there is one solution.
Stores have the forces of the period's mean or end, and no member gives more than what it has left (`StoreParams.over`,
`SourceParams.lasting`).

Energy is conserved: over a period sources + stores = loads + heat of converters + shunts, to rounding
(`NetworkEnergy`). A store's own account is exact too; its terminal energy differs from what its bus saw by what its
voltage moves within a control period (one part in 10^5 for a battery and 20 ms), in longer steps by what its force
bends and by what levelling out costs.
"""

import copy
from collections.abc import Mapping, Sequence
from math import inf, isfinite
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.finite import all_finite
from sojourn_machine.params import FloatArray, IntArray
from sojourn_machine.power.bus_kernels import DRAWN, FED, FLOWS, SERVED, SHUNT, USED, VOLTAGE, operating_point
from sojourn_machine.power.bus_tree import Bus, buses_of, upwards
from sojourn_machine.power.converters import ConverterParams
from sojourn_machine.power.fuses import Fuses, FuseState
from sojourn_machine.power.loads import BusParams, BusState, LoadColumns, LoadParams
from sojourn_machine.power.network_state import NetworkEnergy, NetworkOutput, NetworkState
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.sources import SourceParams, SourcePoint
from sojourn_machine.power.stores import StoreParams
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

NOTHING: FloatArray = np.zeros(0)
NO_STORES: FloatArray = np.zeros((0, 6))
NO_SOURCES: FloatArray = np.zeros((0, 2))
NO_CONVERTER: FloatArray = np.zeros(2)
FREE = BusState()


class _Asked(NamedTuple):
    """What is asked and offered in a period."""

    switches: FloatArray
    """(loads,)"""
    asked: FloatArray
    """(loads,) [W]"""
    offers: Sequence[SourcePoint]
    """Of the sources."""
    dt: float


class _Point(NamedTuple):
    """What was found for one bus."""

    state: BusState
    locked_out: bool
    power: FloatArray
    current: FloatArray
    flows: list[float]
    """As `operating_point` has them."""


class PowerNetwork:
    """The network of a machine.

    Attributes:
        params: of its members. stores, sources, converters: the same by their places; buses: `main` first.
        load_bus: (loads,) place of each load's bus. store_bus: place of each store's bus.
        takes_light: whether a source goes by the light of the surroundings.
        stuck: switches that are stuck, by their place: 0 off, 1 on.
    """

    def __init__(self, params: PowerParams) -> None:
        self.params = params
        self.stores: tuple[StoreParams, ...] = tuple(params.all_stores.values())
        self.sources: tuple[SourceParams, ...] = tuple(params.sources.values())
        self.converters: tuple[ConverterParams, ...] = tuple(params.converters.values())
        self.buses = buses_of(params)
        places = {bus.name: place for place, bus in enumerate(self.buses)}
        self.store_bus = tuple(places[store.bus] for store in self.stores)
        counts = [len(bus.params.loads) for bus in self.buses]
        self._count = len(params.loads)
        self.fuses = Fuses(params.loads) if any(load.fuse is not None for load in params.loads) else None
        self.stuck = {place: float(load.stuck == "on") for place, load in enumerate(params.loads) if load.stuck}
        self._running_out = tuple(place for place, source in enumerate(self.sources) if source.runs_out)
        self.takes_light = any(source.takes_light for source in self.sources)
        self.load_bus: IntArray = np.repeat(np.arange(len(self.buses)), counts)
        self._inputs = tuple(places[converter.input] for converter in self.converters)
        self._outputs = tuple(places[converter.output] for converter in self.converters)
        self._shorts: dict[str, LoadColumns] = {}
        """Of each bus that has a short: its loads with one more."""
        self._upwards = upwards(self.buses, self._inputs)

    def shorted(self, bus: str, resistance: float) -> "PowerNetwork":
        """The same with a resistance from a bus to the frame [ohm], which no switch takes off."""
        other = copy.copy(self)
        short = LoadParams(name="short", kind="resistive", power_w=1.0, voltage_nominal=1.0, essential=True, priority=0)
        one = BusParams(loads=(short,), lockout_voltage=0.0, lockout_reset_voltage=1.0, lockout_reset_time=0.0)
        columns = self._shorts.get(bus, self.params.all_buses[bus].index.columns)
        pairs = zip(columns, one.index.columns._replace(rated=np.array([1.0 / resistance])), strict=True)
        other._shorts = {**self._shorts, bus: LoadColumns(*(np.append(*pair) for pair in pairs))}
        return other

    def initial_state(self, soc: float) -> NetworkState:
        """All stores rested at a state of charge [0..1], nothing switched on yet. Raises InvalidValueError."""
        stores = tuple(store.initial_state(soc) for store in self.stores)
        voltages = []
        for bus in self.buses:
            forces = [self.stores[place].point(stores[place]).source for place in bus.stores]
            held = bus.params.voltage
            voltages.append(max(forces) if forces else 0.0 if held is None else held)
        return NetworkState(
            stores=stores,
            sources=tuple(source.initial_state() for source in self.sources),
            buses=(BusState(),) * len(self.buses),
            voltages=tuple(voltages),
            served=(1.0,) * len(self.buses),
            fuses=None if self.fuses is None else self.fuses.first(),
        )

    def as_switched(self, fractions: FloatArray) -> FloatArray:
        """Switches as they are when they are told to be at fractions (loads,), 0 off to 1 on."""
        if not self.stuck:
            return fractions
        switches = fractions.copy()
        for place, fraction in self.stuck.items():
            switches[place] = fraction
        return switches

    def served_at_loads(self, state: NetworkState) -> float | FloatArray:
        """Part of what it asks that each load was given in the last period, (loads,); one number on one bus [1]."""
        served: float | FloatArray = state.served[0]
        if len(state.served) > 1:
            served = np.array(state.served)[self.load_bus]
        return served if state.fuses is None else np.where(state.fuses.blown, 0.0, served)

    def at_rest(self, state: NetworkState) -> NetworkOutput:
        """What would be seen before the first period: no current flows."""
        none = np.zeros(len(self.params.loads))
        return NetworkOutput(
            voltages=state.voltages,
            served=state.served,
            load_power=none,
            load_current=none,
            store_currents=(0.0,) * len(self.stores),
            source_powers=(0.0,) * len(self.sources),
            converter_powers=(0.0,) * len(self.converters),
            locked_out=(False,) * len(self.buses),
        )

    def step(
        self,
        state: NetworkState,
        fractions: Sequence[float] | FloatArray,
        demand: Sequence[float] | FloatArray,
        dt: float,
        surroundings: PowerSurroundings = DARK,
    ) -> tuple[NetworkState, NetworkOutput]:
        """The network over one period of `dt` [s].

        Args:
            fractions: switch of each load, 0 off to 1 on, shape (loads,) [1].
            demand: power asked by the commanded loads, negative when motors return power; other entries are ignored,
                shape (loads,) [W].

        Raises:
            InvalidValueError: a wrong length, a number that is not finite, a fraction beyond 0 to 1.
        """
        switches = _require_array("load fractions", fractions, self._count)
        asked = _require_array("load demand [W]", demand, self._count)
        if not isfinite(dt) or dt <= 0.0:
            raise InvalidValueError("dt [s]", dt, "a finite number above 0")
        given = switches.tolist()
        if given and (min(given) < 0.0 or max(given) > 1.0):
            raise InvalidValueError("load fractions", given, "0 to 1")
        commanded, fuses = switches, state.fuses
        if fuses is not None:
            switches = switches * ~fuses.blown
        offers = self._offers(state, surroundings, dt) if state.sources else ()
        points = self._solve(state, _Asked(switches, asked, offers, dt))
        output = self._output(points, sum([offer.power for offer in offers]))
        warmth = surroundings.round_stores or (surroundings.temperature,) * len(self.stores)
        stores = tuple(
            [
                store.step(before, current, dt, around)
                for store, before, current, around in zip(
                    self.stores, state.stores, output.store_currents, warmth, strict=True
                )
            ]
        )
        sources = state.sources and tuple(
            [
                source.step(before, power, dt, surroundings)
                for source, before, power in zip(self.sources, state.sources, output.source_powers, strict=True)
            ]
        )
        new = NetworkState(
            stores=stores,
            sources=sources,
            buses=tuple([point.state for point in points]),
            voltages=output.voltages,
            served=output.served,
            energy=self._energy(state.energy, points, output, dt),
            fuses=self._fuses_after(fuses, commanded, output.load_current, dt),
            surroundings=surroundings,
            offers=offers,
        )
        return new, output

    def _offers(self, state: NetworkState, surroundings: PowerSurroundings, dt: float) -> tuple[SourcePoint, ...]:
        """What the sources can give; what one has worked out of the same surroundings stands as long as it holds."""
        known = zip(self.sources, state.sources, strict=True)
        if surroundings is not state.surroundings or not state.offers:
            offers = [source.point(before, surroundings) for source, before in known]
        else:
            offers = [
                offer if source.holds(before) else source.point(before, surroundings)
                for (source, before), offer in zip(known, state.offers, strict=True)
            ]
        for place in self._running_out:
            most = self.sources[place].lasting(state.sources[place], dt)
            offers[place] = offers[place]._replace(power=min(offers[place].power, most))
        return tuple(offers)

    def _fuses_after(
        self, before: FuseState | None, commanded: FloatArray, currents: FloatArray, dt: float
    ) -> FuseState | None:
        return None if self.fuses is None or before is None else self.fuses.after(before, commanded, currents, dt)

    def _solve(self, state: NetworkState, period: _Asked) -> Sequence[_Point]:
        """Every bus: from those that others feed to those that feed them, then back where something falls short."""
        if not self.converters:
            return [self._bus(bus, state, place, period) for place, bus in enumerate(self.buses)]
        points: dict[int, _Point] = {}
        for place in self._upwards:
            points[place] = self._bus(self.buses[place], state, place, period, self._drawn(place, points))
        for place in reversed(self._upwards):
            feeder = self.buses[place].feeder
            if feeder is None:
                continue
            above, converter = points[self._inputs[feeder]], self.converters[feeder]
            wanted = converter.drawn(points[place].flows[FED])
            if wanted > 0.0 and above.flows[SERVED] < 1.0:
                most = converter.given(wanted * above.flows[SERVED])
                drawn = self._drawn(place, points)
                points[place] = self._bus(self.buses[place], state, place, period, drawn, most)
        return [points[place] for place in range(len(self.buses))]

    def _drawn(self, place: int, points: Mapping[int, _Point]) -> FloatArray:
        """Power at the inputs of the converters that a bus feeds [W]."""
        return np.array(
            [self.converters[feeds].drawn(points[self._outputs[feeds]].flows[FED]) for feeds in self.buses[place].feeds]
        )

    def _bus(
        self,
        bus: Bus,
        state: NetworkState,
        place: int,
        period: _Asked,
        drawn: FloatArray = NOTHING,
        most: float | None = None,
    ) -> _Point:
        """One bus, its lockout included. `most`: what its converter can give where that is less than its rating [W]."""
        stores, sources, converter = NO_STORES, NO_SOURCES, NO_CONVERTER
        if bus.stores:
            alone = len(bus.stores) == 1
            points = [self.stores[k].over(state.stores[k], period.dt, alone) for k in bus.stores]
            stores = np.array(points, dtype=np.float64)
        if bus.sources:
            sources = np.array([period.offers[k] for k in bus.sources], dtype=np.float64)
        if bus.feeder is not None:
            feeder = self.converters[bus.feeder]
            least = -feeder.rating_w if feeder.both_ways else 0.0
            converter = np.array([feeder.rating_w if most is None else most, least])
        params, held = bus.params, state.buses[place]
        loads = (params.index.columns, period.switches[bus.loads], period.asked[bus.loads])
        if bus.name in self._shorts:
            columns = self._shorts[bus.name]
            more = len(columns.rated) - len(loads[1])
            loads = (columns, np.append(loads[1], np.ones(more)), np.append(loads[2], np.zeros(more)))
        target = inf if params.voltage is None else params.voltage
        supply = (drawn, stores, sources, converter, target)
        locked = held.locked_out
        found = operating_point(*loads, locked, *supply)
        if not locked and found[2][VOLTAGE] < params.lockout_voltage:
            locked = True
            found = operating_point(*loads, locked, *supply)
        power, current, flows = found
        known = flows.tolist()
        return _Point(_after(params, held, locked, known[VOLTAGE], period.dt), locked, power, current, known)

    def _output(self, points: Sequence[_Point], offered: float) -> NetworkOutput:
        if len(points) == 1 and not self._shorts:
            power, current = points[0].power, points[0].current
        elif self._shorts:  # the current of a short is no load's
            counts = [len(bus.params.loads) for bus in self.buses]
            power = np.concatenate([one.power[:count] for one, count in zip(points, counts, strict=True)])
            current = np.concatenate([one.current[:count] for one, count in zip(points, counts, strict=True)])
        else:
            power = np.concatenate([point.power for point in points])
            current = np.concatenate([point.current for point in points])
        currents, given = [0.0] * len(self.stores), [0.0] * len(self.sources)
        fed = [0.0] * len(self.converters)
        for bus, point in zip(self.buses, points, strict=True):
            flows, last = point.flows, FLOWS + len(bus.stores)
            if len(bus.stores) == 1:
                currents[bus.stores[0]] = _current_of_the_only_store(point)
            else:
                for k, amps in zip(bus.stores, flows[FLOWS:last], strict=True):
                    currents[k] = amps
            for k, watts in zip(bus.sources, flows[last:], strict=True):
                given[k] = watts
            if bus.feeder is not None:
                fed[bus.feeder] = flows[FED]
        return NetworkOutput(
            voltages=tuple([point.flows[VOLTAGE] for point in points]),
            served=tuple([point.flows[SERVED] for point in points]),
            load_power=power,
            load_current=current,
            store_currents=tuple(currents),
            source_powers=tuple(given),
            converter_powers=tuple(fed),
            locked_out=tuple([point.locked_out for point in points]),
            offered=offered,
        )

    def _energy(self, old: NetworkEnergy, points: Sequence[_Point], output: NetworkOutput, dt: float) -> NetworkEnergy:
        """The account after a period."""
        stores = used = lost = shunted = 0.0
        for current, bus in zip(output.store_currents, self.store_bus, strict=True):
            stores += current * output.voltages[bus]
        for point in points:
            flows = point.flows
            used += flows[USED]
            lost += flows[DRAWN] - flows[FED]
            shunted += flows[SHUNT]
        return NetworkEnergy(
            old.sources + sum(output.source_powers) * dt,
            old.stores + stores * dt,
            old.loads + used * dt,
            old.converters + lost * dt,
            old.shunts + shunted * dt,
        )


def _current_of_the_only_store(point: _Point) -> float:
    """Out of the only store of a bus [A]: what the others leave, so that the bus adds up. One that gives and takes
    nothing leaves them nothing to round, over a voltage that may be next to none."""
    flows, current = point.flows, float(point.current.sum())
    if flows[FLOWS] == 0.0:
        return 0.0
    others = flows[DRAWN] - flows[FED] + flows[SHUNT] - sum(flows[FLOWS + 1 :])
    return current + others / flows[VOLTAGE] if others != 0.0 else current


def _after(params: BusParams, before: BusState, locked_out: bool, voltage: float, dt: float) -> BusState:
    """The lockout after a period."""
    if not locked_out:
        return FREE
    waited = before.recovered_for + dt if voltage >= params.lockout_reset_voltage else 0.0
    return FREE if waited > params.lockout_reset_time else BusState(locked_out=True, recovered_for=waited)


def _require_array(name: str, values: Sequence[float] | FloatArray, count: int) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (count,):
        raise InvalidValueError(f"shape of {name}", array.shape, f"({count},), one for each load")
    if not all_finite(array):
        raise InvalidValueError(name, array.tolist(), "finite numbers")
    return array
