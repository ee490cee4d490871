"""What the machine draws at rest beyond what is known of its loads: motors that stand and hold.

    found = power out of the stores - draws of what is on, at the measured voltage - what sources and converters change
    h <- h + g (found - h), or found where that is less than h by more than its noise       found at least 0

One look is taken with each forecast, over the steady window of the switch watch. What motors take at work is more
than what they hold with, and nothing tells the manager that they work: so much less counts at once and all else
slowly, and a drive that was taken for rest is forgotten at the first look after it. Loads that draw more than is known
of them, and an offset of the current's sensor, count with it. None is taken where the difference may be light or heat:
in light that arrays go by (see `array_belief`), while a load on a thermostat is on, and where stores are so full, cold
or much charged that sources may be held back.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from sojourn_flight.power_manager.preview import Preview, PreviewState
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.switch_watch import DEVIATIONS, LEAST_COUNT, SwitchState, Watched, steady
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network import PowerNetwork

GAIN = 0.3
"""Of a look [1]."""
MOMENT = 1.0
"""For which the network is asked what would be drawn [s]."""
HELD_BACK = 0.99
"""Part of the voltage up to which stores are charged, from which on sources may be held back [1]."""


def held_back(network: PowerNetwork, begun: PreviewState, readings: Sequence[StoreReading]) -> bool:
    """Whether stores are so near to where charging ends that sources may give less than they can."""
    stores = zip(network.stores, begun.network.stores, readings, strict=True)
    return any(reading.voltage > HELD_BACK * store.point(state).ceiling for store, state, reading in stores)


class RestingDraw:
    """Looks at what a machine draws at rest.

    Args:
        preview: of the machine as it is believed to be. watched: its loads.
    """

    def __init__(self, preview: Preview, watched: Watched) -> None:
        self._preview, self._watched = preview, watched
        self._moves = np.array([load.kind == "commanded" for load in watched.loads])

    def after(self, held: float, seen: SwitchState, begun: PreviewState, readings: Sequence[StoreReading]) -> float:
        """What is believed after a look [W].

        Args:
            held: before it [W]. seen: steady power and switches. begun: the machine as it is believed to be now.
        """
        if len(seen.window) < LEAST_COUNT or seen.before is not None:
            return held
        mean, scatter = steady(seen.window)
        network, around = self._preview.network, self._preview.around(begun.time)
        if scatter is None or (network.takes_light and around.direct + around.diffuse > 0.0):
            return held
        known = [
            self._watched.draw(int(place), readings[0].voltage) for place in np.flatnonzero(~self._moves & seen.on)
        ]
        if None in known or (network.sources and held_back(network, begun, readings)):
            return held
        _, output = network.step(begun.network, np.array(seen.on, dtype=float), self.of_loads(0.0), MOMENT, around)
        flows = zip(output.store_currents, network.store_bus, strict=True)
        beside = sum([current * output.voltages[bus] for current, bus in flows]) - float(output.load_power.sum())
        found = max(mean - beside - sum([draw for draw in known if draw is not None]), 0.0)
        return found if held - found > DEVIATIONS * sqrt(scatter) else held + GAIN * (found - held)

    def of_loads(self, held: float) -> FloatArray:
        """What each load of motors draws at rest: which of them does is not known, so each its share, (loads,) [W]."""
        return np.where(self._moves, held / max(int(self._moves.sum()), 1), 0.0)
