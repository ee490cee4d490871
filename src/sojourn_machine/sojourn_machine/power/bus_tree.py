"""The buses of a network with what is on each, by places in its lists. Converters make a tree of them."""

from collections.abc import Sequence
from typing import NamedTuple

from sojourn_machine.power.loads import BusParams
from sojourn_machine.power.power_params import PowerParams


class Bus(NamedTuple):
    """One bus with what is on it, by places in the lists of the network."""

    name: str
    params: BusParams
    loads: slice
    stores: tuple[int, ...]
    sources: tuple[int, ...]
    feeder: int | None
    """The converter that holds its voltage."""
    feeds: tuple[int, ...]
    """Converters that draw from it."""


def buses_of(params: PowerParams) -> tuple[Bus, ...]:
    """The buses of a network, `main` first."""
    stores, sources, converters = params.all_stores.values(), params.sources.values(), params.converters.values()
    found, first = [], 0
    for name, bus in params.all_buses.items():
        last = first + len(bus.loads)
        feeders = [place for place, converter in enumerate(converters) if converter.output == name]
        found.append(
            Bus(
                name=name,
                params=bus,
                loads=slice(first, last),
                stores=tuple(place for place, store in enumerate(stores) if store.bus == name),
                sources=tuple(place for place, source in enumerate(sources) if source.bus == name),
                feeder=feeders[0] if feeders else None,
                feeds=tuple(place for place, converter in enumerate(converters) if converter.input == name),
            )
        )
        first = last
    return tuple(found)


def upwards(buses: Sequence[Bus], inputs: Sequence[int]) -> tuple[int, ...]:
    """Places of the buses, those that others feed before those that feed them.

    Args:
        inputs: of each converter, the place of the bus that it draws from.
    """

    def depth(place: int) -> int:
        """Converters between a bus and the one that all is drawn from."""
        feeder = buses[place].feeder
        return 0 if feeder is None else 1 + depth(inputs[feeder])

    return tuple(sorted(range(len(buses)), key=depth, reverse=True))
