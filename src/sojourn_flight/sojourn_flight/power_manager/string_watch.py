"""Failed strings of a store, from the answer of its voltage to steps of its current, and from its fall when one fails.

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

A step is taken from the last reading that began one, and is over once it is large enough or too old.

Where the current is steady nothing steps, but V + R I is level, and the moment in which a string fails it falls by

    J = (r1 - 1) R I

against its mean of late: the same sum of likelihoods decides between 0 and J, with the mean held while it is above 0.
Where it falls by far more than that no string does it, and the mean begins anew; likewise after a leap, a reading later
than the time of the mean, in which the charge has moved the open-circuit voltage.
Then r = 1 + fall / (R I), which the steps that follow confirm or take back.

Range: R is believed better than half of 1 / (n - 1), and the current steps, or is large enough when the string fails. A
store of one string has nothing to compare."""

from dataclasses import dataclass
from math import sqrt

from pydantic import Field

from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.stores import StoreParams

MOST_OF_STEP, MOST_OF_READING = 0.25, 0.1
"""Part of the limit that one step, or one reading against the level, may tell, however clear it is: few false readings
decide nothing."""

DEVIATIONS = 5.0
"""Of readings about the level, by which J has to exceed them."""
LARGEST_FALL = 2.0
"""A fall of so many times that of all strings but one is no string's."""


class StringWatchParams(Params):
    """What a step is, and how sure the watch must be."""

    least_step: float = Field(default=1.0, gt=0.0, le=1e4, description="smallest change of current that tells [A]")
    longest_step: float = Field(default=1.0, gt=0.0, le=60.0, description="time within which it must come [s]")
    least_fall: float = Field(default=0.1, gt=0.0, le=100.0, description="smallest J that tells [V]")
    level_time: float = Field(default=2.0, gt=0.0, le=600.0, description="over which V + R I is averaged [s]")
    voltage_noise: float = Field(default=0.0105, gt=0.0, le=10.0, description="standard deviation of a reading [V]")
    certainty: float = Field(default=16.0, gt=0.0, le=100.0, description="logarithm of the likelihoods' ratio [1]")


@dataclass(frozen=True, slots=True)
class Level:
    """V + R I at a steady current."""

    mean: float
    """[V]"""
    current: float
    """With which it began [A]."""
    time: float = 0.0
    """Since then [s]."""
    variance: float = 0.0
    """About the mean [V^2]."""
    evidence: float = 0.0
    """L of its fall [1]."""


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
    level: "Level | None" = None

    @property
    def ratio(self) -> float:
        """Resistance since L left 0, of what is believed [1]."""
        return self.products / self.squares if self.squares else 1.0


def step(
    params: StringWatchParams, store: StoreParams, before: StringState, reading: StoreReading, dt: float
) -> StringState:
    """The watch after a reading that is in order, `dt` [s] after the last."""
    resistance = store.point(store.initial_state(0.5, reading.temperature)).resistance
    after = _by_steps(params, store.strings, before, (reading, resistance), dt)
    return after if after.failed else _by_level(params, store.strings, after, (reading, resistance), dt)


def _by_steps(
    params: StringWatchParams, strings: int, before: StringState, seen: tuple[StoreReading, float], dt: float
) -> StringState:
    """What the step tells that a reading ends; seen: the reading and the resistance that is believed [ohm]."""
    reading, resistance = seen
    begun, elapsed = before.begun, before.elapsed + dt
    if begun is None or elapsed > params.longest_step:
        return replace(before, begun=reading, elapsed=0.0)
    if abs(reading.current - begun.current) < params.least_step:
        return replace(before, elapsed=elapsed)
    drop, fall = resistance * (reading.current - begun.current), begun.voltage - reading.voltage
    evidence = _told(params, before.evidence, MOST_OF_STEP, (fall - drop, drop / (strings - 1)))
    if evidence == 0.0:
        return replace(before, begun=reading, elapsed=0.0, evidence=0.0, squares=0.0, products=0.0, failed=0)
    squares, products = before.squares + drop * drop, before.products + drop * fall
    after = replace(before, begun=reading, elapsed=0.0, evidence=evidence, squares=squares, products=products)
    return _decided(after, strings) if evidence >= params.certainty else after


def _by_level(
    params: StringWatchParams, strings: int, before: StringState, seen: tuple[StoreReading, float], dt: float
) -> StringState:
    """What a reading tells against the level before it; seen: as in `_by_steps`."""
    reading, resistance = seen
    drop = resistance * reading.current
    level, now = before.level, reading.voltage + drop
    # across a leap of time the open-circuit voltage falls with the charge, as if a string had failed
    if level is None or dt > params.level_time or abs(reading.current - level.current) >= params.least_step:
        return replace(before, level=Level(now, reading.current))
    fall, expected = level.mean - now, drop / (strings - 1)
    if abs(fall) > LARGEST_FALL * max(abs(drop) * (strings - 1), params.least_fall):
        return replace(before, level=Level(now, reading.current))
    evidence = 0.0
    if level.time >= params.level_time and abs(expected) >= max(params.least_fall, DEVIATIONS * sqrt(level.variance)):
        evidence = _told(params, level.evidence, MOST_OF_READING, (fall, expected))
    if evidence >= params.certainty:
        found = replace(before, level=None, evidence=params.certainty, squares=drop * drop)
        return _decided(replace(found, products=drop * (drop + fall)), strings)
    if evidence > 0.0:
        return replace(before, level=replace(level, evidence=evidence))
    share = dt / (min(level.time, params.level_time) + dt)
    mean, variance = level.mean - share * fall, (1.0 - share) * (level.variance + share * fall * fall)
    return replace(before, level=Level(mean, level.current, level.time + dt, variance))


def _told(params: StringWatchParams, evidence: float, part: float, seen: tuple[float, float]) -> float:
    """L after one more number, which may tell so much of the limit; seen: the number, and what it is where a string has
    failed, 0 where all are whole [V].
    """
    found, expected = seen
    told = (found * found - (found - expected) ** 2) / (4.0 * params.voltage_noise**2)
    most = part * params.certainty
    return min(max(evidence + min(max(told, -most), most), 0.0), params.certainty)


def _decided(state: StringState, strings: int) -> StringState:
    """With the strings that have failed, by the resistance that has shown."""
    return replace(state, failed=min(max(round(strings * (1.0 - 1.0 / state.ratio)), 1), strings - 1))
