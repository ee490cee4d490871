"""Telemetry of the power bus: /bus/state of each energy store."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sojourn_contract.messages import battery_readings, battery_state
from sojourn_contract.run_table import STORE, things_of
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_contract.values import NOT_MEASURED
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import bus
from sojourn_physics.sensors.bus import BusTelemetryParams
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

TRUTH = "/truth/electrical"
BEFORE = (0.0, 0.0, 293.15)
"""Voltage [V], current [A] and temperature [K] of a store of which nothing has been told yet."""


class BusSensorParams(BusTelemetryParams, SensorParams):
    """Channels that every store has."""

    kind: str = "bus"
    speaks_on: ClassVar[tuple[Any, ...]] = (topic("/bus/state"),)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)
    alone: ClassVar[bool] = True

    def sensor(self, name: str, site: SensorSite) -> "BusSensor":
        """The telemetry of a machine."""
        return BusSensor(name, self, site)


@dataclass(frozen=True, slots=True)
class BusTelemetryState:
    """What the channels remember, and what was told last of each store: (stores, 3), columns as `bus.CHANNELS`."""

    channels: bus.BusSensorState
    known: FloatArray


class BusSensor(Sensor[BusSensorParams, BusTelemetryState, FloatArray]):
    """Reads in every period, and tells at the rate of its row what it has read; (stores, 3)."""

    speaks_with: ClassVar[tuple[str, ...]] = (TRUTH,)

    def __init__(self, name: str, params: BusSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._stores = things_of(site.scenario)[STORE]
        self._truths = [row.name for row in site.table.each(TRUTH)]

    def rows_on(self, site: SensorSite) -> tuple[Topic, ...]:
        return site.table.each("/bus/state")

    def initial_state(self, truth: Truth) -> BusTelemetryState:
        channels = bus.initial_state(self.params, self.site.seed, self._stores)
        return BusTelemetryState(channels, np.array([BEFORE] * len(self._stores)))

    def step(self, state: BusTelemetryState, truth: Truth, dt: float) -> tuple[BusTelemetryState, FloatArray]:
        known = state.known
        for place, name in enumerate(self._truths):
            message = truth.inputs.get(name)
            if message is not None:
                known = known.copy()
                known[place] = battery_readings(message)
        channels, reading = bus.step(state.channels, known)
        return replace(state, channels=channels, known=known), reading

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        if reading is not None:
            for row, of_store in zip(self.rows, reading, strict=True):
                voltage, current, temperature = of_store
                none = (NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
                yield row.name, battery_state(stamp, voltage, current, temperature, *none)
