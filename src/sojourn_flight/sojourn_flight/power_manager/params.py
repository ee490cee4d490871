"""Parameters of the power manager: its belief about battery and loads, and its law (`manager`)."""

from collections.abc import Collection, Mapping
from functools import cached_property
from math import inf
from typing import Any, Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.loads import LoadParams, require_unique_names


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
    drive_power_limit: float = Field(gt=0.0, le=1e6, description="most power for all drive loads [W]")
    arm_power_limit: float = Field(gt=0.0, le=1e6, description="most power for all arm loads [W]")

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
    """What the manager believes about battery and loads, and its law."""

    battery: BatteryParams
    loads: tuple[LoadParams, ...] = Field(min_length=1, description="the switched loads, in the order of the switches")
    law: PowerLawParams

    @model_validator(mode="after")
    def _check(self) -> Self:
        require_unique_names(self.loads)
        return self

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
    def granted(self) -> tuple[tuple[float, str], ...]:
        """Of each load that is wanted: the fraction of its power that the limit of its group allows, and why."""
        limits = {"drive": self.law.drive_power_limit, "arm": self.law.arm_power_limit}
        granted = []
        for load in self.loads:
            rated = sum(other.power_w for other in self.loads if other.group == load.group)
            limit = limits.get(load.group, inf)
            granted.append(
                (limit / rated, f"{load.group} limited to {limit:.0f} W") if limit < rated else (1.0, "wanted")
            )
        return tuple(granted)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but a changed copy works out its own levels and limits."""
        copied = super().model_copy(update=update, deep=deep)
        for name in ("shed_priorities", "shed_thresholds", "granted"):
            copied.__dict__.pop(name, None)
        return copied
