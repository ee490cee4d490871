"""Switched loads and the bus that they hang on, as a machine's file says them.

A load takes constant power, is a resistor, or draws what its motors ask. Equations: see `bus_kernels`.

The lockout of the power unit takes off every load that is not essential once the voltage of the bus falls below its
trip voltage and gives them back when it has stayed above the reset voltage for the reset time.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray, Params
from sojourn_machine.power.fuses import FuseParams

BoolArray: TypeAlias = NDArray[np.bool_]
LoadKind: TypeAlias = Literal["constant_power", "resistive", "commanded"]


class LoadParams(Params):
    """One switched load. A `commanded` load draws what the caller says (motors), up to `power_w`."""

    name: str = Field(min_length=1, description="name of the load and of its switch")
    kind: LoadKind = Field(description="how its current depends on the bus voltage")
    power_w: float = Field(gt=0.0, le=1e6, description="power while on (commanded: the most it may draw) [W]")
    voltage_nominal: float = Field(
        default=28.0, gt=0.0, le=1e4, description="bus voltage at which a resistive load draws power_w [V]"
    )
    essential: bool = Field(description="never switched off, neither by the manager nor by the lockout")
    priority: int = Field(ge=0, le=1000, description="the smallest number is shed first [1]")
    fuse: FuseParams | None = Field(default=None, description="between it and its bus")
    stuck: Literal["on", "off"] | None = Field(
        default=None, description="its switch stays on or off, whatever it is told: a fault"
    )


class BusParams(Params):
    """The loads in their fixed order and the lockout of the bus."""

    loads: tuple[LoadParams, ...] = Field(default=(), description="the loads, in the order of every array")
    voltage: float | None = Field(
        default=None,
        gt=0.0,
        le=1e4,
        description="that its converter or its sources hold; left out: the one of its stores [V]",
    )
    lockout_voltage: float = Field(ge=0.0, le=1e4, description="bus voltage that trips the lockout; 0: none does [V]")
    lockout_reset_voltage: float = Field(gt=0.0, le=1e4, description="bus voltage that may reset it [V]")
    lockout_reset_time: float = Field(
        ge=0.0, le=3600.0, description="time above the reset voltage before loads come back [s]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.lockout_reset_voltage <= self.lockout_voltage:
            raise ValueError(
                f"lockout_reset_voltage = {self.lockout_reset_voltage}: "
                f"allowed is above lockout_voltage, {self.lockout_voltage} V"
            )
        return self

    @cached_property
    def index(self) -> "LoadIndex":
        """The loads as arrays, made once."""
        columns = LoadColumns(
            rated=np.array([load.power_w for load in self.loads], dtype=np.float64),
            resistive=np.array([load.kind == "resistive" for load in self.loads]),
            commanded=np.array([load.kind == "commanded" for load in self.loads]),
            essential=np.array([load.essential for load in self.loads]),
            nominal_squared=np.array([load.voltage_nominal**2 for load in self.loads], dtype=np.float64),
        )
        return LoadIndex(columns)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but a changed copy makes its own index."""
        copied = super().model_copy(update=update, deep=deep)
        copied.__dict__.pop("index", None)
        return copied


class LoadColumns(NamedTuple):
    """Columns of the load table, each of shape (loads,)."""

    rated: FloatArray
    resistive: BoolArray
    commanded: BoolArray
    essential: BoolArray
    nominal_squared: FloatArray


@dataclass(frozen=True, eq=False, slots=True)
class LoadIndex:
    """What the kernels are given of the loads. Parameters are compared without it."""

    columns: LoadColumns


@dataclass(frozen=True, slots=True)
class BusState:
    """What the bus remembers."""

    locked_out: bool = False
    """The lockout holds every load that is not essential off."""
    recovered_for: float = 0.0
    """Time above the reset voltage while locked out [s]."""
