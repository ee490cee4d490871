"""Parameters of the power manager: its belief about the power hardware, and its law (`law`)."""

from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from sojourn_flight.power_manager.faults import RecognitionParams
from sojourn_flight.power_manager.forecast_params import ForecastParams
from sojourn_flight.power_manager.kalman import KalmanParams
from sojourn_flight.power_manager.modes import SLEEP, SleepParams
from sojourn_flight.power_manager.switch_watch import Watched
from sojourn_flight.power_manager.switchboard import Switchboard
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_machine.power.loads import LoadParams
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.stores import MAIN, StoreParams


class PowerLawParams(Params):
    """Thresholds and time constants of the law."""

    rest_current: float = Field(gt=0.0, le=1e4, description="a current no larger than this is rest [A]")
    rest_time: float = Field(ge=0.0, le=1e5, description="rest before the voltage corrects the charge [s]")
    correction_time_constant: float = Field(
        gt=0.0, le=1e6, description="time constant of the correction of the charge [s]"
    )
    filter_time_constant: float = Field(
        gt=0.0, le=1e3, description="low-pass of voltage and current for correction and shedding [s]"
    )
    shed_soc_first: float = Field(ge=0.0, le=1.0, description="charge below which the first level is shed [1]")
    shed_soc_last: float = Field(ge=0.0, le=1.0, description="charge below which the last level is shed [1]")
    shed_soc_hysteresis: float = Field(gt=0.0, le=0.5, description="charge above a threshold to restore [1]")
    shed_voltage: float = Field(gt=0.0, le=1e4, description="filtered bus voltage below which loads are shed [V]")
    shed_voltage_hysteresis: float = Field(gt=0.0, le=1e3, description="voltage above it to restore [V]")
    shed_interval: float = Field(gt=0.0, le=1e4, description="time below between two levels shed [s]")
    restore_interval: float = Field(gt=0.0, le=1e5, description="time above between two levels restored [s]")
    derate_start_voltage: float = Field(gt=0.0, le=1e4, description="bus voltage at which drive is first limited [V]")
    derate_stop_voltage: float = Field(gt=0.0, le=1e4, description="bus voltage at which drive has no power [V]")
    derate_time_constant: float = Field(
        gt=0.0, le=100.0, description="time constant with which the drive fraction follows the voltage [s]"
    )
    recovery_rate: float = Field(gt=0.0, le=1e3, description="fastest rise of the drive fraction [1/s]")
    estimator: Literal["coulomb", "kalman"] = Field(
        default="coulomb", description="of the charge: counting corrected at rest, or an extended Kalman filter"
    )
    kalman: KalmanParams = KalmanParams()
    sleep: SleepParams | None = Field(default=None, description="when the machine sleeps; left out: never")
    faults: RecognitionParams = RecognitionParams()
    forecast: ForecastParams = ForecastParams()
    load_limits: dict[str, Annotated[float, Field(gt=0.0, le=1e6)]] = Field(
        default_factory=dict, description="most power for a load by its name; for others what they are rated for [W]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        for upper, lower in (
            ("shed_soc_first", "shed_soc_last"),
            ("derate_start_voltage", "derate_stop_voltage"),
        ):
            high, low = getattr(self, upper), getattr(self, lower)
            equal_allowed = upper != "derate_start_voltage"
            if high < low or (high == low and not equal_allowed):
                raise ValueError(f"{upper} = {high}: allowed is above {lower}, {low}")
        if self.shed_soc_first + self.shed_soc_hysteresis > 1.0:
            raise ValueError("shed_soc_first + shed_soc_hysteresis: allowed is 1 at most, or nothing is restored")
        return self


class PowerManagerParams(Params):
    """What the manager believes about stores and loads, and its law."""

    power: PowerParams = Field(description="the network as it is believed to be")
    law: PowerLawParams
    derated: tuple[str, ...] = Field(
        default=(), description="loads that drive the machine: they have less power while the voltage of the bus is low"
    )
    on_thermostats: tuple[str, ...] = Field(default=(), description="loads that draw only while a thermostat asks")

    @model_validator(mode="after")
    def _check(self) -> Self:
        names = [load.name for load in self.loads]
        for name in (*self.law.load_limits, *self.derated):
            if name not in names:
                raise InvalidValueError("load_limits", name, "a load of the bus: " + names_text(name, names))
        asleep = () if self.law.sleep is None else self.law.sleep.loads
        essential = [load.name for load in self.loads if load.essential]
        for name in asleep:
            if name not in essential:
                raise InvalidValueError("sleep.loads", name, "an essential load: " + names_text(name, essential))
        if SLEEP in names:
            raise InvalidValueError(
                "name of a load", SLEEP, "another: operators ask by it for the sleep of the machine"
            )
        if not self.power.all_stores:
            raise InvalidValueError("stores", (), "at least one: the manager goes by the charge")
        return self

    @property
    def loads(self) -> tuple[LoadParams, ...]:
        """The switched loads, in the order of the switches."""
        return self.power.loads

    @cached_property
    def stores(self) -> tuple[StoreParams, ...]:
        """The stores, in the order of the estimates."""
        return tuple(self.power.all_stores.values())

    @cached_property
    def watched(self) -> int:
        """Place of the store whose bus is watched for low voltage: the first on `main`, or the first of all."""
        return next((place for place, store in enumerate(self.stores) if store.bus == MAIN), 0)

    @cached_property
    def switch_watch(self) -> Watched:
        """What of the loads their switches are watched by."""
        return Watched(self.power, self.on_thermostats)

    @cached_property
    def switchboard(self) -> Switchboard:
        """What the loads are switched to."""
        return Switchboard(self)

    @cached_property
    def shares(self) -> tuple[float, ...]:
        """Part of all energy that each store holds when all are full [1]."""
        full = [store.stored_energy(1.0) for store in self.stores]
        return tuple(energy / sum(full) for energy in full)

    @cached_property
    def ratios(self) -> tuple[float, ...]:
        """Voltage of each half full store over that of the first: what a charge in it is worth beside its [1]."""
        halves = [store.open_circuit_voltage(0.5) for store in self.stores]
        return tuple(voltage / halves[0] for voltage in halves)

    def stored_energy(self, charges: Collection[float]) -> float:
        """Energy above empty in all stores at these states of charge [J]."""
        return sum([store.stored_energy(soc) for store, soc in zip(self.stores, charges, strict=True)])

    def reserve(self, names: Collection[str]) -> float:
        """Charge at which the first of these loads is shed [1]; 0 if none of them may be."""
        thresholds = dict(zip(self.shed_priorities, self.shed_thresholds, strict=True))
        loads = (load for load in self.loads if load.name in names and not load.essential)
        return max((thresholds[load.priority] for load in loads), default=0.0)

    @cached_property
    def shed_priorities(self) -> tuple[int, ...]:
        """Priorities of the loads that may be shed, the first to be shed first; one level each."""
        return tuple(sorted({load.priority for load in self.loads if not load.essential}))

    @cached_property
    def shed_thresholds(self) -> tuple[float, ...]:
        """Charge below which each level is shed, falling [1]."""
        levels = len(self.shed_priorities)
        span = self.law.shed_soc_first - self.law.shed_soc_last
        return tuple(self.law.shed_soc_first - span * k / max(levels - 1, 1) for k in range(levels))

    @cached_property
    def shed_words(self) -> tuple[str, ...]:
        """Why each level is shed for its charge."""
        return tuple(f"charge was below {threshold:.1%}" for threshold in self.shed_thresholds)

    @cached_property
    def granted(self) -> tuple[tuple[float, str], ...]:
        """Of each load that is wanted: the fraction of its power that its limit allows, and why."""
        granted = []
        for load in self.loads:
            limit = self.law.load_limits.get(load.name, load.power_w)
            limited = limit < load.power_w
            granted.append(
                (limit / load.power_w, f"{load.name} limited to {limit:.0f} W") if limited else (1.0, "wanted")
            )
        return tuple(granted)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but a changed copy works out its own levels and limits."""
        copied = super().model_copy(update=update, deep=deep)
        levels = ("shed_priorities", "shed_thresholds", "shed_words", "granted")
        for name in ("stores", "watched", "switch_watch", "switchboard", "shares", "ratios", *levels):
            copied.__dict__.pop(name, None)
        return copied
