"""Faults on readings, for every kind of sensor without code of its own.

Which faults a sensor has is part of its state (`FaultyState`), so whoever holds the state may switch them. What is lost
on the way (dead, dropout) is no matter of readings: see `sojourn_contract.delivery`.

A kind whose readings are arrays, or dataclasses of arrays, needs nothing. Another one says how it takes a fault in
`Sensor.faulted`.
"""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_config.errors import single
from sojourn_machine.chance import chance, stream_of
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_machine.timing import CONTROL_PERIOD_NS, NANOSECONDS

SPECK = 0.035
"""Width of a speck of dust, as the lens sees it [rad]: two degrees."""
_SIGN, _DUST = 1 << 32, 1 << 40
"""Salts of the signs of spikes, below it those of the numbers; of the specks of dust, about the middle of the view."""


@dataclass(frozen=True, slots=True)
class FaultNow:
    """A numerical fault at a stamp.

    Args:
        params: of the fault. time: since it is there [s]. stream: of its chance. number: of the period.
    """

    params: SensorFaultParams
    time: float
    stream: int
    number: int

    def on(self, values: Any) -> Any:
        """Numbers of a reading with the fault on them, of the same kind and shape; what is no number, as the infinity
        of a beam that does not come back, stays as it is. Raises ValueError for a fault of another shape.
        """
        told, params = np.asarray(values), self.params
        parts = [np.asarray(part) for part in (params.scale, params.bias, params.drift)]
        if any(part.shape not in ((), told.shape) for part in parts):
            raise ValueError(f"one number, or as many as there are, {told.shape}")
        scale, bias, drift = parts
        finite = np.isfinite(told)
        wrong = scale * np.where(finite, told, 0.0) + bias + drift * self.time
        if params.spike_probability > 0.0:
            wrong = wrong + self._spikes(told.size).reshape(told.shape)
        wrong = np.where(finite, wrong, told)
        return float(wrong) if isinstance(values, float) else wrong.astype(told.dtype)

    def hidden(self, directions: FloatArray) -> NDArray[np.bool_]:
        """Which rays meet dust, (n,): specks of SPECK that stay where they are on the lens, over a share `dust` of it.

        Args:
            directions: in the frame of the lens, (n, 3), of any length.
        """
        x, y, z = np.asarray(directions, dtype=float).T
        cells = np.floor(np.column_stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))]) / SPECK).astype(int)
        specks, place = np.unique(cells, axis=0, return_inverse=True)
        dusty = [chance(self.stream, _DUST + across, up + _DUST) < self.params.dust for across, up in specks.tolist()]
        return np.array(dusty, dtype=bool)[place.reshape(-1)]

    def _spikes(self, count: int) -> FloatArray:
        probability, size = self.params.spike_probability, self.params.spike_size
        spikes = np.zeros(count)
        for place in range(count):
            if chance(self.stream, place, self.number) < probability:
                spikes[place] = size if chance(self.stream, _SIGN + place, self.number) < 0.5 else -size
        return spikes


@dataclass(frozen=True, slots=True)
class FaultyState:
    """What is wrong with a sensor, by the names of the faults, and what it said last while it had power and was not
    stuck.
    """

    faults: tuple[tuple[str, SensorFaultParams], ...]
    last: Any = None


class FaultHook:
    """Of one sensor with faults.

    Args:
        sensor: whose readings they are on.
    """

    def __init__(self, sensor: Any) -> None:
        self._sensor = sensor

    def check(self, faults: Mapping[str, SensorFaultParams], reading: Any) -> None:
        """Raise ConfigError for one of these faults that a reading cannot have; of none nothing can be told."""
        for name, fault in faults.items():
            if not fault.is_numerical or reading is None:
                continue
            try:
                self._sensor.faulted(reading, FaultNow(fault, 1.0, self._stream(name), 1))
            except ValueError as error:
                raise single("sensors", f"{self._sensor.name}.faults.{name}", fault.of, str(error)) from error

    def step(self, state: FaultyState, reading: Any, stamp: int) -> tuple[FaultyState, Any]:
        """What the sensor, which has power, says at a stamp [ns] where it would say `reading`; None is said as it
        is.
        """
        if reading is None:
            return state, None
        present = [(name, fault) for name, fault in state.faults if stamp >= round(fault.after * NANOSECONDS)]
        if any(fault.stuck for _, fault in present) and state.last is not None:
            reading = state.last
        else:
            state = FaultyState(state.faults, reading)
        for name, fault in present:
            if fault.is_numerical:
                time = stamp / NANOSECONDS - fault.after
                now = FaultNow(fault, time, self._stream(name), stamp // CONTROL_PERIOD_NS)
                reading = self._sensor.faulted(reading, now)
        return state, reading

    def _stream(self, name: str) -> int:
        return stream_of(self._sensor.site.seed, f"{self._sensor.name} {name}")


def changes_readings(fault: SensorFaultParams) -> bool:
    """Whether a fault is a matter of hooks."""
    return fault.is_numerical or fault.stuck


def faulted(reading: Any, fault: FaultNow) -> Any:
    """A reading with a fault on its numbers: an array, a number, a dataclass with the array that the fault names, or a
    tuple that ends with one of these.

    Raises:
        ValueError: with what is allowed.
    """
    of = fault.params.of
    if fault.params.dust > 0.0:
        raise ValueError("no dust: it has no lens")
    if isinstance(reading, tuple) and reading:
        return (*reading[:-1], faulted(reading[-1], fault))
    if dataclasses.is_dataclass(reading):
        names = [each.name for each in dataclasses.fields(reading) if _is_numbers(getattr(reading, each.name))]
        if of not in names:
            raise ValueError(f"a fault of one of {', '.join(names)}")
        return dataclasses.replace(reading, **{of: fault.on(getattr(reading, of))})  # type: ignore[type-var]
    if of or not _is_numbers(reading):
        raise ValueError("no quantity: there is one alone" if of else "none that changes numbers: it has none")
    return fault.on(reading)


def _is_numbers(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, np.ndarray) and np.issubdtype(value.dtype, np.floating))
