"""Power and charge over the next hours, with bounds: three previews from what is known now.

    expected   the charges as estimated, the light and the loads as expected
    low        charges less two of their deviations, light less `light_error`, loads more `load_error`
    high       the other way round

The bounds are not a probability: they are what the machine comes to where all errors are as large as they are taken to
be, and all in one direction.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sojourn_flight.power_manager.activities import SECONDS_PER_HOUR, Activities, ActivityParams
from sojourn_flight.power_manager.array_belief import ArrayBelief, with_clean
from sojourn_flight.power_manager.forecast_params import ForecastParams
from sojourn_flight.power_manager.law import PowerManagerState
from sojourn_flight.power_manager.modes import SleepState
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.preview import Around, Preview, PreviewState, PreviewStep, Warmth, believed
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.resting_draw import RestingDraw
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.loads import BusParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.surroundings import PowerSurroundings
from sojourn_machine.thermal.machine_heat import HeatState

LOOKS_APART = 60.0
"""Time from one look to the next [s]."""
MOST_MOMENTS = 4096
"""That are kept of light and warmth, see `_moments`."""
COLUMNS = ("charge", "charge_low", "charge_high", "offered_w", "used_w")
"""Of a forecast: charge of all stores as expected and its bounds [1], the most that all sources could give and what all
loads take, as expected [W]."""


class PowerForecast(NamedTuple):
    """What is ahead."""

    times: FloatArray
    """From now, (n,) [s]."""
    values: FloatArray
    """(n, 5), see COLUMNS."""
    words: str
    """What comes first that limits the machine, if all goes as expected and at the earliest."""


def nothing_foreseen(why: str) -> PowerForecast:
    """Of a machine that cannot be reckoned with."""
    return PowerForecast(np.zeros(0), np.zeros((0, len(COLUMNS))), f"nothing can be foreseen: {why}")


class Known(NamedTuple):
    """What a forecast begins with."""

    time: float
    """After the start of the run [s]."""
    manager: PowerManagerState
    readings: Sequence[StoreReading]
    """Telemetry of each store."""
    heat: HeatState | None = None
    """As it is believed to be; None: as at the start of a run."""
    clean: float | None = None
    """Part of its light that is believed to reach an array's cells [1]; None: as the array's file has it."""
    held: float = 0.0
    """Believed to be drawn at rest beyond what is known of the loads [W]."""


class Forecaster:
    """Makes forecasts for a machine.

    Args:
        params: of the manager, with the table `forecast`. activities: what is planned.
        around: light and warmth that are expected, by the time after the start of the run [s].
        warmth: the machine's heat, by which its heaters switch; None: they take what their loads are rated for.

    Raises:
        InvalidValueError: an activity that the machine cannot carry out.
    """

    def __init__(
        self,
        params: PowerManagerParams,
        activities: Sequence[ActivityParams],
        around: Around,
        warmth: Warmth | None = None,
    ) -> None:
        self._params, self._settings = params, params.law.forecast
        planned, kept = Activities(params, activities), lru_cache(_moments(self._settings))
        more, brighter = self._settings.load_error, self._settings.light_error
        if warmth is not None:
            warmth = warmth._replace(around=kept(warmth.around))
        self._previews = tuple(
            Preview(
                params,
                PowerNetwork(_with_loads(params.power, 1.0 + sign * more)),
                planned.times(1.0 + sign * more),
                kept(_brighter(around, 1.0 - sign * brighter)),
                warmth,
            )
            for sign in (0.0, 1.0, -1.0)
        )
        self._arrays = ArrayBelief(self._previews[0], params.switch_watch)
        self._resting = RestingDraw(self._previews[0], params.switch_watch)
        low = self._previews[1]
        self._asleep = Preview(params, low.network, Activities(params, ()), low.around, warmth)

    def warm_up(self) -> None:
        """Have every compiled kernel of the network ready."""
        preview = self._previews[0]
        preview.run(preview.initial_state(0.5), self._settings.step, 1)

    def forecast(self, known: Known) -> PowerForecast:
        """The hours ahead."""
        expected, low, high = (
            self._run(preview, known, shift) for preview, shift in zip(self._previews, (0.0, -2.0, 2.0), strict=True)
        )
        charges = [[self._charge(step) for step in steps] for steps in (expected, low, high)]
        values = np.empty((len(expected), len(COLUMNS)))
        values[:, 0] = charges[0]
        values[:, 1] = np.minimum(charges[1], charges[0])  # a machine that sheds earlier may come out above
        values[:, 2] = np.maximum(charges[2], charges[0])
        values[:, 3] = [step.network.offered for step in expected]
        values[:, 4] = [float(step.network.load_power.sum()) for step in expected]
        times = np.array([step.time - known.time for step in expected])
        return PowerForecast(times, values, self._words(known.time, expected, low))

    def clean_after(self, known: Known) -> float | None:
        """Part of their light that is believed to reach the cells of the arrays, after a look at what they give [1];
        None of a machine without any.
        """
        clean = self._arrays.at_start if known.clean is None else known.clean
        if clean is None:
            return None
        begun = self._begun(self._previews[0], known._replace(clean=clean), known.manager)
        return self._arrays.after(clean, known.manager.faults.switches, begun, known.readings)

    def held_after(self, known: Known) -> float:
        """What is believed to be drawn at rest beyond what is known of the loads, after a look at the stores [W]."""
        begun = self._begun(self._previews[0], known, known.manager)
        return self._resting.after(known.held, known.manager.faults.switches, begun, known.readings)

    def heat_after(self, known: Known, time: float) -> HeatState | None:
        """Heat as it is believed to be at a later time [s], if all went as expected; None for a machine without."""
        preview = self._previews[0]
        begun = self._begun(preview, known, known.manager)
        if begun.heat is None or time <= known.time:
            return begun.heat
        return preview.step(begun, time - known.time)[0].heat

    def least_asleep(self, known: Known) -> float | None:
        """The lowest charge that lies ahead if the machine sleeps from now on, less its errors [1]; None where its law
        does not ask for it.
        """
        sleep = self._params.law.sleep
        if sleep is None or sleep.reserve is None:
            return None
        asleep = replace(known.manager, sleep=SleepState(asleep=True, foreseen=True))
        steps = self._run(self._asleep, known._replace(manager=asleep), -2.0)
        return min(self._charge(step) for step in steps)

    def _run(self, preview: Preview, known: Known, shift: float) -> list[PreviewStep]:
        """One preview from charges that are so many deviations off."""
        stores = []
        for store in known.manager.stores:
            sigma = self._settings.charge_sigma if store.filter is None else store.filter.sigma
            stores.append(replace(store, soc=min(max(store.charge + shift * sigma, 0.0), 1.0), filter=None))
        shifted = replace(known.manager, stores=tuple(stores))
        return preview.run(self._begun(preview, known, shifted), self._settings.step, self._settings.count)

    def _begun(self, preview: Preview, known: Known, manager: PowerManagerState) -> PreviewState:
        """A preview at the charges that a manager has, arrays as clean and motors holding as is believed."""
        network = with_clean(preview.network, believed(preview.network, manager, known.readings), known.clean)
        return preview.begin(known.time, manager, network, known.heat, self._resting.of_loads(known.held))

    def _charge(self, step: PreviewStep) -> float:
        """Of all stores, which the step that empties one leaves a little below 0 [1]."""
        charge = sum([share * soc for share, soc in zip(self._params.shares, step.charges, strict=True)])
        return min(max(charge, 0.0), 1.0)

    def _words(self, time: float, expected: Sequence[PreviewStep], low: Sequence[PreviewStep]) -> str:
        found, earliest = first_limit(expected), first_limit(low)
        least = min(self._charge(step) for step in expected)
        text = f"charge at least {least:.1%} over {self._settings.hours:g} h"
        if found is not None:
            text = f"{limit_text(found)} in {(found.time - time) / SECONDS_PER_HOUR:.1f} h"
        empty = next((step for step in expected if self._charge(step) <= 0.0), None)
        if empty is not None:
            text += f"; empty in {(empty.time - time) / SECONDS_PER_HOUR:.1f} h"
        if self._previews[0].network.sources and all(step.network.offered == 0.0 for step in expected):
            text += "; no source gives anything"
        if earliest is not None and (found is None or earliest.time < found.time):
            text += f"; at the earliest {limit_text(earliest)} in {(earliest.time - time) / SECONDS_PER_HOUR:.1f} h"
        return text


def first_limit(steps: Sequence[PreviewStep]) -> PreviewStep | None:
    """The first step in which more is shed than in the one before it, but for planned sleep, or in which a bus cannot
    give what is asked of it; None where there is none.
    """
    for before, step in pairwise(steps):
        if step.sleeps_by_plan:
            continue
        if step.manager.shed_level > before.manager.shed_level or step.network.brownout > before.network.brownout:
            return step
    return None


def limit_text(step: PreviewStep) -> str:
    """What limits the machine in a step, in words."""
    if step.network.brownout:
        return "a bus cannot give what is asked of it"
    return f"{step.manager.mode} ({step.manager.mode_reason})"


def _moments(settings: ForecastParams) -> int:
    """Moments of light and warmth that are kept. A look asks for those of the look one step before it, and one more:
    so many as there are in the hours ahead of all looks in a step, and a quarter for what is asked of the present. With
    more of them, those that have passed would be kept, and memory would grow for days.
    """
    looks = max(math.ceil(settings.step / LOOKS_APART), 1)
    return min(5 * settings.count * looks // 4 + 64, MOST_MOMENTS)


def _brighter(around: Around, factor: float) -> Around:
    if factor == 1.0:
        return around

    def scaled(time: float) -> PowerSurroundings:
        here = around(time)
        return here._replace(direct=factor * here.direct, diffuse=factor * here.diffuse)

    return scaled


def _with_loads(power: PowerParams, factor: float) -> PowerParams:
    """The network whose loads take so many times their power."""
    if factor == 1.0:
        return power

    def of(bus: BusParams) -> BusParams:
        loads = tuple(load.model_copy(update={"power_w": factor * load.power_w}) for load in bus.loads)
        return bus.model_copy(update={"loads": loads})

    return power.model_copy(
        update={"bus": of(power.bus), "buses": {name: of(bus) for name, bus in power.buses.items()}}
    )
