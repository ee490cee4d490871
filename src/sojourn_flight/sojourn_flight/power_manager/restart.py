"""A manager whose process was started again: what the one before knew goes on, or loads come back in stages.

Kept is what cannot be found again soon: what was asked of the loads, sleep, levels shed, the belief of each store, and
faults that only a change of current shows. What was drawn since is counted with the first telemetry; that it may have
been as much as all loads are rated for is added to the deviation of each charge.
"""

from dataclasses import asdict
from typing import Any, Self, TypeAlias

import numpy as np
from pydantic import Field, model_validator

from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.charge_estimate import StoreEstimate
from sojourn_flight.power_manager.kalman import CHARGE, INVERSE_CAPACITY, STATES, KalmanState
from sojourn_flight.power_manager.law import PowerManagerState
from sojourn_flight.power_manager.modes import SleepState
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.requests import switched
from sojourn_flight.power_manager.string_watch import StringState
from sojourn_flight.power_manager.switch_watch import StuckSwitch
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.stores import StoreParams

Numbers: TypeAlias = tuple[float, ...]


class KeptFilter(Params):
    """Mean (6,) and covariance (6, 6) of the filter of a charge."""

    mean: Numbers
    covariance: tuple[Numbers, ...]

    @model_validator(mode="after")
    def _check(self) -> Self:
        state = self.state
        if state.mean.shape != (STATES,) or state.covariance.shape != (STATES, STATES):
            raise ValueError(f"allowed are {STATES} numbers and {STATES} x {STATES} numbers")
        if state.mean[INVERSE_CAPACITY] <= 0.0 or (np.diag(state.covariance) < 0.0).any():
            raise ValueError("allowed are a capacity above 0 and variances of at least 0")
        return self

    @property
    def state(self) -> KalmanState:
        """As the filter has it."""
        return KalmanState(np.array(self.mean), np.array(self.covariance))


class KeptStore(Params):
    """Belief of a store."""

    soc: float | None = Field(ge=0.0, le=1.0, description="state of charge [1]; none before the first telemetry")
    filter: KeptFilter | None
    strings: StringState


class KeptManager(Params):
    """What a manager keeps."""

    wanted: dict[str, bool]
    sleep: SleepState
    level_by_charge: int = Field(ge=0)
    level_by_voltage: int = Field(ge=0)
    drive_fraction: float = Field(ge=0.0, le=1.0)
    stores: dict[str, KeptStore]
    stuck: tuple[StuckSwitch, ...]


def kept_values(params: PowerManagerParams, state: PowerManagerState) -> dict[str, Any]:
    """What the next process is to know, as JSON has it."""
    beliefs = zip(params.power.all_stores, state.stores, state.faults.strings, strict=True)
    return {
        "wanted": dict(zip([load.name for load in params.loads], state.wanted, strict=True)),
        "sleep": asdict(state.sleep),
        "level_by_charge": state.level_by_charge,
        "level_by_voltage": state.level_by_voltage,
        "drive_fraction": state.drive_fraction,
        "stores": {name: _kept_store(store, strings) for name, store, strings in beliefs},
        "stuck": [asdict(one) for one in state.faults.switches.stuck],
    }


def manager_of(params: PowerManagerParams, kept: KeptManager, elapsed: float) -> PowerManagerState:
    """The manager that has kept this, `elapsed` [s] ago.

    Raises:
        InvalidValueError, UnknownNameError: it is of another machine.
    """
    new = law.initial_state(params)
    levels, names = len(params.shed_priorities), list(params.power.all_stores)
    if max(kept.level_by_charge, kept.level_by_voltage) > levels:
        raise InvalidValueError("levels", max(kept.level_by_charge, kept.level_by_voltage), f"{levels} at most")
    if list(kept.stores) != names:
        raise InvalidValueError("stores", list(kept.stores), ", ".join(names))
    for (name, one), store in zip(kept.stores.items(), params.stores, strict=True):
        if not 0 <= one.strings.failed < store.strings:
            raise InvalidValueError(f"failed strings of {name}", one.strings.failed, f"below {store.strings}")
    if kept.sleep.asleep and params.law.sleep is None:
        raise InvalidValueError("sleep.asleep", True, "no sleep: the law knows none")
    stores = zip(params.stores, kept.stores.values(), strict=True)
    switches = replace(new.faults.switches, stuck=kept.stuck)
    return replace(
        new,
        stores=tuple(_store(params, store, one, elapsed) for store, one in stores),
        wanted=switched(params, new.wanted, kept.wanted),
        level_by_charge=kept.level_by_charge,
        level_by_voltage=kept.level_by_voltage,
        drive_fraction=kept.drive_fraction,
        sleep=kept.sleep,
        faults=replace(new.faults, strings=tuple(one.strings for one in kept.stores.values()), switches=switches),
    )


def _kept_store(store: StoreEstimate, strings: StringState) -> dict[str, Any]:
    known = store.filter
    arrays = None if known is None else {"mean": known.mean.tolist(), "covariance": known.covariance.tolist()}
    return {"soc": store.soc, "filter": arrays, "strings": asdict(replace(strings, begun=None, level=None))}


def _store(params: PowerManagerParams, store: StoreParams, kept: KeptStore, elapsed: float) -> StoreEstimate:
    if kept.filter is None or kept.soc is None or params.law.estimator != "kalman":
        return StoreEstimate(kept.soc)
    most, known = sum(load.power_w for load in params.loads) / store.open_circuit_voltage(0.5), kept.filter.state
    known.covariance[CHARGE, CHARGE] += min(most * elapsed / store.charge_capacity, 1.0) ** 2
    return StoreEstimate(kept.soc, filter=known)
