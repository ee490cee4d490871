"""The power hardware of a machine, `power.yaml`: stores, sources and converters by their names, and buses with their
loads.

A machine with one battery has the tables `battery` and `bus` and no other word; `battery` is a store like those in
`stores`, and the first of them. A member names its bus where that is not the one of the table `bus`, which is `main`.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from math import isinf
from typing import Annotated, Any, Self

from pydantic import Field, SerializeAsAny, ValidationError, model_validator
from pydantic_core import InitErrorDetails

from sojourn_machine.choice import kinds_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.converters import ConverterParams
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.sources import SOURCES, SourceParams
from sojourn_machine.power.stores import MAIN, STORES, StoreParams

BATTERY = "battery"
"""Name of the store that has a table of its own."""
Store = Annotated[SerializeAsAny[StoreParams], *kinds_of(STORES, "kind")]
Source = Annotated[SerializeAsAny[SourceParams], *kinds_of(SOURCES, "kind")]
Place = tuple[tuple[str | int, ...], object, str]
"""Of what is wrong: keys, value, what is allowed."""


class PowerParams(Params):
    """Any number of stores, sources, converters and loads on buses."""

    battery: BatteryParams | None = Field(default=None, description="the store of energy, or the first of several")
    stores: dict[str, Store] = Field(default_factory=dict, description="further stores by their names")
    sources: dict[str, Source] = Field(
        default_factory=dict,
        description="sources by their names; of those on one bus the first is used before the next",
    )
    converters: dict[str, ConverterParams] = Field(default_factory=dict, description="converters by their names")
    bus: BusParams = Field(description="the bus `main`: its loads and lockout")
    buses: dict[str, BusParams] = Field(default_factory=dict, description="further buses by their names")

    @cached_property
    def all_stores(self) -> dict[str, StoreParams]:
        """The stores by their names, in the order of all reports."""
        return {**({} if self.battery is None else {BATTERY: self.battery}), **self.stores}

    @cached_property
    def all_buses(self) -> dict[str, BusParams]:
        """The buses by their names, `main` first."""
        return {MAIN: self.bus, **self.buses}

    @cached_property
    def loads(self) -> tuple[LoadParams, ...]:
        """The loads of all buses, in the order of every array."""
        return tuple(load for bus in self.all_buses.values() for load in bus.loads)

    @cached_property
    def feeders(self) -> dict[str, ConverterParams]:
        """The converter that holds the voltage of a bus, by the name of the bus."""
        return {converter.output: converter for converter in self.converters.values()}

    def stores_on(self, bus: str) -> dict[str, StoreParams]:
        """The stores on a bus by their names."""
        return {name: store for name, store in self.all_stores.items() if store.bus == bus}

    def with_load(self, load: LoadParams) -> Self:
        """The same with one more load on the bus `main`."""
        return self.model_copy(update={"bus": self.bus.model_copy(update={"loads": (*self.bus.loads, load)})})

    def lowest_voltage(self, bus: str = MAIN) -> float:
        """Of a bus whose stores are empty [V]; the one that is held where it has none."""
        empty = [store.open_circuit_voltage(0.0) for store in self.stores_on(bus).values()]
        held = self.all_buses[bus].voltage
        return min(empty) if empty else 0.0 if held is None else held

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but a changed copy makes its own tables."""
        copied = super().model_copy(update=update, deep=deep)
        for name in ("all_stores", "all_buses", "loads", "feeders"):
            copied.__dict__.pop(name, None)
        return copied

    def most_power(self, bus: str, *beyond: str) -> float:
        """That a bus can ever be given [W]; infinite where a store has no resistance.

        Args:
            beyond: buses that are not asked: what they can give is for them.
        """
        sources = [source.most_power for source in self.sources.values() if source.bus == bus]
        stores = [store.most_power for store in self.stores_on(bus).values()]
        feeder, fed = self.feeders.get(bus), 0.0
        if feeder is not None and feeder.input not in beyond:
            fed = feeder.given(self.most_power(feeder.input, bus, *beyond))
        back = [
            min(one.rating_w, one.efficiency * self.most_power(one.output, bus, *beyond))
            for one in self.converters.values()
            if one.both_ways and one.input == bus and one.output not in beyond
        ]
        return sum((*sources, *stores, fed, *back))

    def load_problems(self) -> Iterator[Place]:
        """Loads that are larger than all that can ever feed them, or than their fuses carry."""
        for name, bus in self.all_buses.items():
            most = self.most_power(name)
            keys: tuple[str, ...] = ("bus",) if name == MAIN else ("buses", name)
            for place, load in enumerate(bus.loads):
                if load.power_w > most and not isinf(most):
                    allowed = (
                        f"allowed is at most {most:.4g} W, all that stores, sources and converter of {name} can give"
                    )
                    yield (*keys, "loads", place, "power_w"), load.power_w, allowed
                lowest = self.lowest_voltage(name)
                if load.fuse is not None and load.fuse.rating_a * lowest < load.power_w:
                    allowed = (
                        f"allowed is at least {load.power_w / lowest:.4g} A, which {load.name} takes at {lowest:.4g} V"
                    )
                    yield (*keys, "loads", place, "fuse", "rating_a"), load.fuse.rating_a, allowed

    def lasting_shortfall(self) -> str | None:
        """In words, that what is never shed takes more than all sources can ever give; None where it does not, or where
        there are only stores.
        """
        given = sum(source.most_power for source in self.sources.values())
        taken = sum(load.power_w for load in self.loads if load.essential and load.kind != "commanded")
        if not self.sources or taken <= given:
            return None
        return f"essential loads take {taken:.4g} W and all sources give {given:.4g} W at most: the stores run empty"

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        found = [
            InitErrorDetails(
                type="value_error",
                loc=keys,
                input=value,
                ctx={"error": InvalidValueError(str(keys[-1]), value, allowed)},
            )
            for keys, value, allowed in (*self._names(), *self._places(), *self._cycles(), *self._voltages())
        ]
        if found:
            raise ValidationError.from_exception_data(type(self).__name__, found)
        return self

    def _names(self) -> Iterator[Place]:
        """Names are used once: topics and switches go by them."""
        seen: dict[str, str] = {BATTERY: "the table battery"} if self.battery is not None else {}
        for table in ("stores", "sources", "converters", "buses"):
            for name in getattr(self, table):
                if not (name.isidentifier() and name.isascii()):
                    yield (table, name), name, "letters, digits and underscores, no digit first"
                if name in seen or name == MAIN:
                    yield (table, name), name, f"another name: {seen.get(name, 'the bus of the table bus')} has it"
                seen[name] = f"one of {table}"
        for bus, params in self.all_buses.items():
            keys: tuple[str, ...] = ("bus",) if bus == MAIN else ("buses", bus)
            for place, load in enumerate(params.loads):
                if load.name in seen:
                    yield (*keys, "loads", place, "name"), load.name, f"another name: {seen[load.name]} has it"
                seen[load.name] = f"a load of {bus}"
        if not self.loads:
            yield ("bus", "loads"), (), "at least one load on one of the buses"

    def _places(self) -> Iterator[Place]:
        """Members are on buses that there are, and each bus has something that feeds it."""
        names = tuple(self.all_buses)
        ways = [(("stores", name, "bus") if name in self.stores else (BATTERY, "bus"), store.bus)
                for name, store in self.all_stores.items()]  # fmt: skip
        ways += [(("sources", name, "bus"), source.bus) for name, source in self.sources.items()]
        for name, converter in self.converters.items():
            ways += [
                (("converters", name, "input"), converter.input),
                (("converters", name, "output"), converter.output),
            ]
        for keys, bus in ways:
            if bus not in names:
                yield keys, bus, "a bus that there is: " + names_text(bus, names)
        fed = {bus for keys, bus in ways if keys[-1] != "input"}
        for bus in names:
            if bus not in fed:
                table: tuple[str, ...] = ("bus",) if bus == MAIN else ("buses", bus)
                yield table, bus, "a bus with a store, a source or the output of a converter; this one has none"
        outputs = [converter.output for converter in self.converters.values()]
        for name, converter in self.converters.items():
            if outputs.count(converter.output) > 1:
                allowed = f"a bus that no other converter holds; {outputs.count(converter.output)} hold this one"
                yield ("converters", name, "output"), converter.output, allowed

    def _cycles(self) -> Iterator[Place]:
        """Power comes from somewhere: no bus feeds itself."""
        for name, converter in self.converters.items():
            way = [converter.output, converter.input]
            while way[-1] in self.feeders and way[-1] not in way[:-1]:
                way.append(self.feeders[way[-1]].input)
            if way[-1] == converter.output:
                ring = " <- ".join(way)
                yield (
                    ("converters", name, "input"),
                    converter.input,
                    f"a bus that does not hang on its own output: {ring}",
                )

    def _voltages(self) -> Iterator[Place]:
        """What has no store, or a converter, is held at a voltage."""
        for name, bus in self.all_buses.items():
            if bus.voltage is None and (name in self.feeders or not self.stores_on(name)):
                keys: tuple[str, ...] = ("bus", "voltage") if name == MAIN else ("buses", name, "voltage")
                why = "its converter holds it" if name in self.feeders else "without a store its sources hold it"
                yield keys, None, f"a voltage above 0 V: {why}"
