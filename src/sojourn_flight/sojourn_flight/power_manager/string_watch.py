"""Failed strings of a store, from the answer of its voltage to steps of its current.

Between two readings a second apart at most neither the open-circuit voltage nor the polarisation moves much, so that

    -dV = r x + e,   x = R(T) dI,   e of variance s^2 = 2 sigma_V^2

R is the believed resistance in series at the measured temperature, r what it is of that. A store of n equal strings
of which k have failed has r = n / (n - k). Between r = 1 and r1 = n / (n - 1) decides the cumulative sum of the
logarithm of their likelihoods (Page 1954, "Continuous inspection schemes", Biometrika 41), held between 0 and its
limit h:

    L <- min(max(L + ((-dV - x)^2 - (-dV - r1 x)^2) / (2 s^2), 0), h)

A string has failed once L is at h, and has not once L is back at 0: so noise does not make it change. False alarms
are e^h steps apart or more on the average (Lorden 1971). r itself is the least squares over the steps since L left 0,
which is the likeliest time of the failure.

A step is taken from the last reading that began one, and is over once it is large enough or too old. Range: R is
believed better than half of 1 / (n - 1), and the current steps. A store of one string has nothing to compare."""

from dataclasses import dataclass

from pydantic import Field

from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.stores import StoreParams

MOST_OF_ONE = 0.25
"""Part of the limit that one step may tell, however clear it is: one false reading decides nothing."""


class StringWatchParams(Params):
    """What a step is, and how sure the watch must be."""

    least_step: float = Field(default=1.0, gt=0.0, le=1e4, description="smallest change of current that tells [A]")
    longest_step: float = Field(default=1.0, gt=0.0, le=60.0, description="time within which it must come [s]")
    voltage_noise: float = Field(default=0.0105, gt=0.0, le=10.0, description="standard deviation of a reading [V]")
    certainty: float = Field(default=16.0, gt=0.0, le=100.0, description="logarithm of the likelihoods' ratio [1]")


@dataclass(frozen=True, slots=True)
class StringState:
    """What is known of the strings of one store."""

    begun: StoreReading | None = None
    """From which the next step is taken."""
    elapsed: float = 0.0
    """Since then [s]."""
    evidence: float = 0.0
    """L [1]."""
    squares: float = 0.0
    """Sum of x^2 since L left 0 [V^2]."""
    products: float = 0.0
    """Likewise of -x dV [V^2]."""
    failed: int = 0
    """Strings that have failed [1]."""

    @property
    def ratio(self) -> float:
        """Resistance since L left 0, of what is believed [1]."""
        return self.products / self.squares if self.squares else 1.0


def step(
    params: StringWatchParams, store: StoreParams, before: StringState, reading: StoreReading, dt: float
) -> StringState:
    """The watch after a reading that is in order, `dt` [s] after the last."""
    begun, elapsed = before.begun, before.elapsed + dt
    if begun is None or elapsed > params.longest_step:
        return replace(before, begun=reading, elapsed=0.0)
    if abs(reading.current - begun.current) < params.least_step:
        return replace(before, elapsed=elapsed)
    believed = store.point(store.initial_state(0.5, reading.temperature)).resistance
    drop, seen = believed * (reading.current - begun.current), begun.voltage - reading.voltage
    one_less = drop * store.strings / (store.strings - 1)
    told = ((seen - drop) ** 2 - (seen - one_less) ** 2) / (4.0 * params.voltage_noise**2)
    most = MOST_OF_ONE * params.certainty
    evidence = min(max(before.evidence + min(max(told, -most), most), 0.0), params.certainty)
    if evidence == 0.0:
        return StringState(reading)
    squares, products = before.squares + drop * drop, before.products + drop * seen
    after = StringState(reading, 0.0, evidence, squares, products, before.failed)
    if evidence < params.certainty:
        return after
    return replace(after, failed=min(max(round(store.strings * (1.0 - 1.0 / after.ratio)), 1), store.strings - 1))
