"""Currents of the strings of a bus, each a load behind its switch: /currents/NAME.

Current of a load is its power over the voltage of its bus, which that of a store on the bus is. Stores and sources have
their own (/bus/state). Each string has a channel of its own with noise, offset, range and resolution, see `bus`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.run_table import STORE, things_of
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors.bus import ChannelParams
from sojourn_physics.sensors.channels import ChannelsState, initial_channels, read_channels
from sojourn_sensors.part_temperature import LOADS, STORES
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/currents",
    "diagnostic_msgs/DiagnosticArray",
    "sensors",
    (),
    5,
    0.5,
    "measured current of loads: `current LOAD`; nothing while the sensor has no power",
    (FieldRule("status.values", "A"),),
    all_named=True,
)


class StringCurrentsParams(SensorParams):
    """Current sensors of some loads, all alike."""

    kind: str = "string_currents"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)
    loads: tuple[str, ...] = Field(min_length=1, description="loads whose current is measured, on a bus with a store")
    current: ChannelParams = Field(description="channel of each [A]")

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        return (MachinePart("loads", "string", self.loads),)

    def sensor(self, name: str, site: SensorSite) -> "StringCurrents":
        """The sensors of a machine's loads."""
        return StringCurrents(name, self, site)


@dataclass(frozen=True, eq=False, slots=True)
class CurrentsMemory:
    """The channels, and what was told last: of each load (n,) [W], of each store (stores,) [V]."""

    channels: ChannelsState
    power: FloatArray
    voltage: FloatArray


class StringCurrents(Sensor[StringCurrentsParams, CurrentsMemory, FloatArray]):
    """Currents, (loads,) [A]; read where the plant tells powers and voltages."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: StringCurrentsParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._voltages = [row.name for row in site.table.each(STORES)]
        self._stores = np.array([_store_of(site, load) for load in params.loads], dtype=np.int64)

    def initial_state(self, truth: Truth) -> CurrentsMemory:
        loads = self.params.loads
        channels = initial_channels(self.params.current, self.site.seed, [f"{self.name}.{load}" for load in loads])
        return CurrentsMemory(channels, np.zeros(len(loads)), np.ones(len(self._voltages)))

    def step(self, state: CurrentsMemory, truth: Truth, dt: float) -> tuple[CurrentsMemory, FloatArray]:
        power, voltage = state.power, state.voltage.copy()
        loads = truth.inputs.get(LOADS)
        if loads is not None:
            power = self._powers(status_values(loads))
        for place, topic in enumerate(self._voltages):
            message = truth.inputs.get(topic)
            if message is not None:
                voltage[place] = message.voltage
        on_bus = voltage[self._stores]
        true = np.divide(power, on_bus, out=np.zeros_like(power), where=on_bus > 0.0)
        channels, reading = read_channels(self.params.current, state.channels, true)
        return CurrentsMemory(channels, power, voltage), reading

    def step_without_power(self, state: CurrentsMemory, truth: Truth, dt: float) -> tuple[CurrentsMemory, None]:
        return self.step(state, truth, dt)[0], None

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        rows = [] if reading is None else zip(self.params.loads, reading.tolist(), strict=True)
        yield self.topic, status_message(stamp, self.name, {f"current {load}": f"{amps:.6g}" for load, amps in rows})

    def _powers(self, values: dict[str, str]) -> FloatArray:
        try:
            return np.array([float(values.get(f"power {load}", 0.0)) for load in self.params.loads])
        except ValueError as error:
            raise InvalidValueError(f"{LOADS} power", str(error), "numbers") from None


def _store_of(site: SensorSite, load: str) -> int:
    """Place of the first store on the bus of a load."""
    power: PowerParams = site.scenario.power
    (bus,) = (name for name, params in power.all_buses.items() if load in [each.name for each in params.loads])
    return things_of(site.scenario)[STORE].index(next(iter(power.stores_on(bus))))
