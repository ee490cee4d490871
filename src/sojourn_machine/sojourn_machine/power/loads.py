"""Loads on the bus, the bus voltage they settle at, and the under-voltage lockout.

Equations. The battery is a source E behind a resistance R. Loads of constant power P, of conductance G and
of given current I0 share the bus at voltage V:

    V = E - R (P/V + G V + I0)    so    (1 + R G) V^2 - (E - R I0) V + R P = 0

The upper root is the stable operating point (Middlebrook 1976, "Input filter considerations", IEEE IAS: a
load of constant power has a negative incremental resistance). With E' = E - R I0 there is no root when

    P > E'^2 / (4 R (1 + R G)),

the most power the source can give: the bus is browned out. It then sits at the point of most power,
V = E' / (2 (1 + R G)), and the constant-power loads share what there is.

The lockout of the power unit takes off every load that is not essential once V falls below its trip voltage
and gives them back when V has stayed above the reset voltage for the reset time.
Assumptions: one bus, no dynamics of the bus capacitor (settles in well under a millisecond).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any, Literal, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, Params

BoolArray: TypeAlias = NDArray[np.bool_]
LoadGroup: TypeAlias = Literal["computer", "communication", "heater", "instrument", "drive", "steer", "arm", "other"]
LoadKind: TypeAlias = Literal["constant_power", "resistive", "commanded"]


class LoadParams(Params):
    """One switched load. A `commanded` load draws what the caller says (motors), up to `power_w`."""

    name: str = Field(min_length=1, description="name of the load and of its switch")
    group: LoadGroup = Field(description="what the load belongs to")
    kind: LoadKind = Field(description="how its current depends on the bus voltage")
    power_w: float = Field(gt=0.0, le=1e6, description="power while on (commanded: the most it may draw) [W]")
    voltage_nominal: float = Field(
        default=28.0, gt=0.0, le=1e4, description="bus voltage at which a resistive load draws power_w [V]"
    )
    essential: bool = Field(description="never switched off, neither by the manager nor by the lockout")
    priority: int = Field(ge=0, le=1000, description="the smallest number is shed first [1]")


class BusParams(Params):
    """The loads in their fixed order and the lockout of the bus."""

    loads: tuple[LoadParams, ...] = Field(min_length=1, description="the loads, in the order of every array")
    lockout_voltage: float = Field(ge=0.0, le=1e4, description="bus voltage that trips the lockout [V]")
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
        require_unique_names(self.loads)
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


@dataclass(frozen=True, slots=True)
class BusOutput:
    """The operating point of one period. Arrays have shape (loads,) in the order of the parameters."""

    voltage: float
    """Bus voltage [V]."""
    current: float
    """Current out of the battery [A]."""
    load_power: FloatArray
    """Power that each load receives [W]."""
    load_current: FloatArray
    """Current that each load receives [A]."""
    served: float
    """Part of the asked constant power that the source can give, 1 unless browned out [1]."""
    brownout: bool
    """The source cannot give the power that is asked."""
    locked_out: bool
    """The lockout is holding loads off in this period."""


def step(
    params: BusParams,
    state: BusState,
    source: float,
    resistance: float,
    fractions: Sequence[float] | FloatArray,
    demand: Sequence[float] | FloatArray,
    dt: float,
) -> tuple[BusState, BusOutput]:
    """The bus over one period of `dt` [s].

    Args:
        source: open-circuit voltage less polarisation, from `battery.thevenin` [V]. resistance: series
        resistance of the source [ohm]. fractions: switch of each load, 0 off to 1 on, shape (loads,) [1].
        demand: power asked by the commanded loads, negative when motors return power; other entries are
        ignored,
            shape (loads,) [W].

    Raises:
        InvalidValueError: a wrong length, a number that is not finite, a fraction beyond 0 to 1.
    """
    switches = _require_array("load fractions", fractions, len(params.loads))
    asked = _require_array("load demand [W]", demand, len(params.loads))
    _require_numbers(source=source, resistance=resistance, dt=dt)
    given = switches.tolist()
    if min(given, default=0.0) < 0.0 or max(given, default=0.0) > 1.0:
        raise InvalidValueError("load fractions", given, "0 to 1")

    held = state.locked_out
    output = _operate(params, source, resistance, switches, asked, held)
    if not held and output.voltage < params.lockout_voltage:
        held = True
        output = _operate(params, source, resistance, switches, asked, held)
    if not held:
        return BusState(), output
    waited = state.recovered_for + dt if output.voltage >= params.lockout_reset_voltage else 0.0
    if waited > params.lockout_reset_time:
        return BusState(), output
    return BusState(locked_out=True, recovered_for=waited), output


@njit(cache=True)
def solve_bus(
    source: float, resistance: float, power: float, conductance: float, current: float
) -> tuple[float, float]:
    """Bus voltage [V] and the part of `power` that is served [1], less than 1 in a brown-out.

    Args:
        source, resistance: of the battery [V], [ohm].
        power: constant power asked, negative when returned [W].
        conductance: of the resistive loads, not negative [S].
        current: drawn whatever the voltage [A].
    """
    lifted = source - resistance * current
    factor = 1.0 + resistance * conductance
    if lifted <= 0.0:
        return 0.0, 0.0 if power > 0.0 else 1.0
    discriminant = lifted * lifted - 4.0 * factor * resistance * power
    if discriminant < 0.0:
        return 0.5 * lifted / factor, 0.25 * lifted * lifted / (factor * resistance * power)
    return 0.5 * (lifted + np.sqrt(discriminant)) / factor, 1.0


def _operate(
    params: BusParams,
    source: float,
    resistance: float,
    switches: FloatArray,
    asked: FloatArray,
    locked_out: bool,
) -> BusOutput:
    voltage, served, power, current = _operating_point(
        params.index.columns, float(source), float(resistance), switches, asked, locked_out
    )
    return BusOutput(
        voltage=voltage,
        current=float(current.sum()),
        load_power=power,
        load_current=current,
        served=served,
        brownout=served < 1.0,
        locked_out=locked_out,
    )


@njit(cache=True)
def _operating_point(
    loads: LoadColumns,
    source: float,
    resistance: float,
    switches: FloatArray,
    asked: FloatArray,
    locked_out: bool,
) -> tuple[float, float, FloatArray, FloatArray]:
    """Bus voltage [V], part served [-], power [W] and current [A] of each load."""
    rated, count = loads.rated, loads.rated.shape[0]
    power, conductances = np.zeros(count), np.zeros(count)
    for i in range(count):
        on = 0.0 if locked_out and not loads.essential[i] else switches[i]
        if on <= 0.0:  # takes nothing, and gives nothing back either
            continue
        if loads.resistive[i]:
            conductances[i] = on * rated[i] / loads.nominal_squared[i]
        else:
            power[i] = min(asked[i], on * rated[i]) if loads.commanded[i] else on * rated[i]
    wanted = power.sum()
    voltage, served = solve_bus(source, resistance, wanted, conductances.sum(), 0.0)
    if voltage <= 0.0:
        return voltage, 1.0 if served >= 1.0 else 0.0, np.zeros(count), np.zeros(count)
    if served < 1.0:
        # What motors return goes to the others whole; only what is asked is cut.
        asked_power = np.maximum(power, 0.0).sum()
        returned = asked_power - wanted
        served = (served * (asked_power - returned) + returned) / asked_power
    for i in range(count):
        if power[i] > 0.0:
            power[i] *= served
        power[i] += conductances[i] * voltage**2
    return voltage, served, power, power / voltage


def require_unique_names(loads: Sequence[LoadParams]) -> None:
    """Refuse two loads of one name with a ValueError that says which."""
    names = [load.name for load in loads]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"load name {name!r} appears {names.count(name)} times: allowed is once")


def _require_array(name: str, values: Sequence[float] | FloatArray, count: int) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (count,):
        raise InvalidValueError(f"shape of {name}", array.shape, f"({count},), one for each load")
    # A sum is not finite where one of its numbers is not, and may be too large where all are.
    if not isfinite(sum(array.tolist())) and not np.isfinite(array).all():
        raise InvalidValueError(name, array.tolist(), "finite numbers")
    return array


def _require_numbers(source: float, resistance: float, dt: float) -> None:
    if not isfinite(source) or source < 0.0:
        raise InvalidValueError("source voltage [V]", source, "a finite number, 0 or above")
    if not isfinite(resistance) or resistance < 0.0:
        raise InvalidValueError("source resistance [ohm]", resistance, "a finite number, 0 or above")
    if not isfinite(dt) or dt <= 0.0:
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
