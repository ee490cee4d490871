"""Faults that telemetry shows, in words and numbers: undervoltage of a bus, limits of a store exceeded, failed strings,
stuck switches.

A symptom is a fault once it has lasted for `confirm_time`, and none any more once it has stayed away for `clear_time`:
one noisy reading neither makes nor ends one. Failed strings and stuck switches are told by watches of their own
(`string_watch`, `switch_watch`).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from pydantic import Field

from sojourn_flight.power_manager import string_watch
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.string_watch import StringState, StringWatchParams
from sojourn_flight.power_manager.switch_watch import SwitchState, SwitchWatchParams
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.power_params import PowerParams

FAILED_STRING = "failed string"


class RecognitionParams(Params):
    """Times of the recognition."""

    confirm_time: float = Field(default=1.0, ge=0.0, le=1e4, description="a symptom that lasts so long is a fault [s]")
    clear_time: float = Field(default=10.0, ge=0.0, le=1e5, description="and is over when away for so long [s]")
    strings: StringWatchParams = StringWatchParams()
    switches: SwitchWatchParams = SwitchWatchParams()


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong."""

    place: str
    """The store or the bus."""
    kind: str
    """In words, the same for every fault of the kind."""
    numbers: str
    """What was measured last when it showed."""

    @property
    def text(self) -> str:
        """For people."""
        return f"{self.place} {self.kind}: {self.numbers}"


@dataclass(frozen=True, slots=True)
class Symptom:
    """A fault, or what may become one."""

    fault: Fault
    present_for: float = 0.0
    """Time in which it has shown without a break [s]."""
    absent_for: float = 0.0
    """Time since it showed last [s]."""
    confirmed: bool = False


@dataclass(frozen=True, slots=True)
class FaultState:
    """What is remembered of symptoms, by place and kind, of the strings of each store, and of switches."""

    symptoms: Mapping[tuple[str, str], Symptom] = field(default_factory=dict)
    strings: tuple[StringState, ...] = ()
    switches: SwitchState = field(default_factory=SwitchState)


def initial_state(power: PowerParams) -> FaultState:
    """Nothing has shown."""
    return FaultState(strings=(StringState(),) * len(power.all_stores))


def step(
    params: RecognitionParams, power: PowerParams, state: FaultState, readings: tuple[StoreReading, ...], dt: float
) -> FaultState:
    """After the telemetry of a period of `dt` [s], one reading a store."""
    stores = power.all_stores.values()
    strings = tuple(
        [
            string_watch.step(params.strings, store, before, reading, dt) if store.strings > 1 else before
            for store, before, reading in zip(stores, state.strings, readings, strict=True)
        ]
    )
    shown = {(fault.place, fault.kind): fault for fault in _shown(power, readings)}
    if not shown and not state.symptoms:
        return replace(state, strings=strings)
    return replace(state, symptoms=_after(params, state.symptoms, shown, dt), strings=strings)


def recognised(power: PowerParams, state: FaultState) -> tuple[Fault, ...]:
    """What is a fault now."""
    found = [symptom.fault for symptom in state.symptoms.values() if symptom.confirmed]
    for (name, store), strings in zip(power.all_stores.items(), state.strings, strict=True):
        if strings.failed:
            numbers = f"{strings.failed} of {store.strings}, resistance {strings.ratio:.2f} of what is believed"
            found.append(Fault(name, FAILED_STRING, numbers))
    found += [Fault(one.load, one.kind, one.numbers) for one in state.switches.stuck]
    return tuple(found)


def _after(
    params: RecognitionParams,
    before: Mapping[tuple[str, str], Symptom],
    shown: Mapping[tuple[str, str], Fault],
    dt: float,
) -> Mapping[tuple[str, str], Symptom]:
    symptoms = {}
    for key, fault in shown.items():
        old = before.get(key, Symptom(fault))
        lasted = old.present_for + dt
        symptoms[key] = Symptom(fault, lasted, confirmed=old.confirmed or lasted >= params.confirm_time)
    for key, old in before.items():
        if key not in shown and old.confirmed and old.absent_for + dt < params.clear_time:
            symptoms[key] = replace(old, present_for=0.0, absent_for=old.absent_for + dt)
    return symptoms


def _shown(power: PowerParams, readings: tuple[StoreReading, ...]) -> Iterator[Fault]:
    buses = power.all_buses
    for (name, store), reading in zip(power.all_stores.items(), readings, strict=True):
        for kind in store.limits_exceeded(reading.temperature, reading.current):
            yield Fault(name, kind, f"{reading.current:.1f} A at {reading.temperature:.1f} K")
        bus = buses[store.bus]
        if bus.lockout_voltage > 0.0 and reading.voltage < bus.lockout_reset_voltage:
            numbers = f"{reading.voltage:.2f} V, least {bus.lockout_reset_voltage:.1f} V"
            yield Fault(store.bus, "undervoltage", numbers)
