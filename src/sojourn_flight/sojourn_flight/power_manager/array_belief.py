"""How much of their power the arrays give: dust, and whatever else lies between them and what was expected.

    given = sum of the draws of what is on - power out of the stores - what other sources give
    y <- y + g (given / (expected / y) - y)                                          held within 0.02 and 1

y is the part of the light that is believed to come through, as `clean` of an array has it, and expected is made with
it. One look is taken with each forecast, over the steady window of the switch watch. None is taken where the stores are
so full, cold or much charged that the arrays are held back (their bus is within a hundredth of where charging
ends), where loads draw what nobody knows, and where little light is expected. Motors that hold a load draw what
`resting_draw` has found in the dark; before, they show as dust: a look that finds more than is believed counts twice.
"""

from collections.abc import Sequence

import numpy as np

from sojourn_flight.power_manager.preview import Preview, PreviewState
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.resting_draw import held_back
from sojourn_flight.power_manager.switch_watch import LEAST_COUNT, SwitchState, Watched, steady
from sojourn_machine.evolution import replace
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.network_state import NetworkState
from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams

GAIN, UPWARDS = 0.15, 2.0
"""Of a look [1]; by how much a look that finds more counts more."""
LEAST, MOST = 0.02, 1.0
"""That is believed [1]."""
LEAST_LIGHT = 0.1
"""Part of the most that the arrays can ever give, below which no look is taken [1]."""
WARMED, WARMING_STEPS = 1800.0, 3
"""Time over which the arrays are warmed in the light before a look [s], and in how many steps."""


def with_clean(network: PowerNetwork, state: NetworkState, clean: float | None) -> NetworkState:
    """The network with its arrays as clean as is believed [1]; None: as their files have it."""
    if clean is None:
        return state
    sources = [
        replace(before, clean=clean) if isinstance(source, PhotovoltaicArrayParams) else before
        for source, before in zip(network.sources, state.sources, strict=True)
    ]
    return replace(state, sources=tuple(sources))


class ArrayBelief:
    """Looks at what the arrays of a machine give.

    Args:
        preview: of the machine as it is believed to be. watched: its loads.
    """

    def __init__(self, preview: Preview, watched: Watched) -> None:
        self._preview, self._watched = preview, watched
        network = preview.network
        arrays = {
            place: source for place, source in enumerate(network.sources) if isinstance(source, PhotovoltaicArrayParams)
        }
        self._arrays, self._most = frozenset(arrays), sum(source.most_power for source in arrays.values())
        self.at_start = min((source.clean for source in arrays.values()), default=None)
        """As their files have it [1]; None without any."""

    def after(self, clean: float, seen: SwitchState, begun: PreviewState, readings: Sequence[StoreReading]) -> float:
        """What is believed after a look.

        Args:
            clean: before it [1]. seen: steady power and switches. begun: the machine as it is believed to be now, its
                arrays as clean.
        """
        if len(seen.window) < LEAST_COUNT:
            return clean
        mean, scatter = steady(seen.window)
        if scatter is None or seen.before is not None or held_back(self._preview.network, begun, readings):
            return clean
        drawn = self._drawn(seen, readings)
        expected, others = self._expected(begun)
        if drawn is None or expected < LEAST_LIGHT * self._most:
            return clean
        found = clean * (drawn + float(np.sum(begun.held)) - mean - others) / expected
        gain = GAIN * (UPWARDS if found > clean else 1.0)
        return min(max(clean + gain * (min(max(found, 0.0), MOST) - clean), LEAST), MOST)

    def _drawn(self, seen: SwitchState, readings: Sequence[StoreReading]) -> float | None:
        """By all that is on [W]; None where a load on a thermostat is."""
        total = 0.0
        for place, on in enumerate(seen.on):
            draw = self._watched.draw(place, readings[0].voltage) if on else 0.0
            if draw is None and self._watched.loads[place].kind != "commanded":
                return None
            total += draw or 0.0
        return total

    def _expected(self, begun: PreviewState) -> tuple[float, float]:
        """Of the arrays, warmed by the light of now, and of the other sources [W]."""
        network, around = self._preview.network, self._preview.around(begun.time)
        arrays, others = 0.0, 0.0
        for place, (source, state) in enumerate(zip(network.sources, begun.network.sources, strict=True)):
            for _ in range(WARMING_STEPS if place in self._arrays else 0):
                given = source.point(state, around).power
                state = source.step(state, given, WARMED / WARMING_STEPS, around)
            power = source.point(state, around).power
            arrays, others = (arrays + power, others) if place in self._arrays else (arrays, others + power)
        return arrays, others
