"""Telemetry of the power bus: voltage, current and temperature through a noisy, offset, quantised channel.

    measured = resolution * round((truth + offset + sigma * n) / resolution), kept within the range of the
    channel

The offset is drawn once at the reset (1 sigma = `offset`), n is standard normal and new in every period.
One channel of each kind for each energy store. Charge is not measured: no sensor sees it. Assumption: the
noise is white at the rate of the telemetry; the range clips as a converter does.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams, quantise_within
from sojourn_physics.sensors.truth import require_numbers

CHANNELS = ("voltage", "current", "temperature")


class ChannelParams(Params):
    """One telemetry channel. Units are those of the quantity: V, A or K."""

    resolution: float = Field(gt=0.0, le=1e3, description="step of the converter [unit of the channel]")
    noise: float = Field(ge=0.0, le=1e3, description="standard deviation of the noise [unit of the channel]")
    offset: float = Field(ge=0.0, le=1e3, description="standard deviation of the offset [unit of the channel]")
    minimum: float = Field(ge=-1e6, le=1e6, description="least reading [unit of the channel]")
    maximum: float = Field(ge=-1e6, le=1e6, description="largest reading [unit of the channel]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.maximum <= self.minimum:
            raise ValueError(f"maximum = {self.maximum}: allowed is above minimum, {self.minimum}")
        return self


class BusTelemetryParams(Params):
    """The three channels that every energy store has."""

    voltage: ChannelParams = Field(description="bus voltage [V]")
    current: ChannelParams = Field(description="current, out of the store positive [A]")
    temperature: ChannelParams = Field(description="temperature of the store [K]")


@dataclass(frozen=True, eq=False, slots=True)
class BusSensorState:
    """Offsets, random streams and ranges of the stores' channels: each (stores * 3,), store by store, as CHANNELS."""

    offset: FloatArray
    noise: FloatArray
    """Standard deviations."""
    resolution: FloatArray
    minimum: FloatArray
    maximum: FloatArray
    stream: NoiseStream
    """Of all stores, one after another."""


def initial_state(params: BusTelemetryParams, seed: int, stores: tuple[str, ...]) -> BusSensorState:
    """Telemetry of the named stores, offsets drawn. A store's numbers depend on its own name only."""
    channels = [getattr(params, name) for name in CHANNELS] * len(stores)

    def column(name: str) -> FloatArray:
        return np.array([getattr(channel, name) for channel in channels], dtype=np.float64)

    stream, row = draw(initial_streams(seed, {f"bus.{store}": len(CHANNELS) for store in stores}))
    return BusSensorState(
        offset=row * column("offset"),
        noise=column("noise"),
        resolution=column("resolution"),
        minimum=column("minimum"),
        maximum=column("maximum"),
        stream=stream,
    )


def step(state: BusSensorState, truth: FloatArray) -> tuple[BusSensorState, FloatArray]:
    """Measure `truth`, shape (stores, 3), columns as CHANNELS; returns the state and the readings, alike.

    Raises:
        InvalidValueError: a truth of another shape, or not finite.
    """
    require_numbers("truth of the bus", truth, (state.offset.size // len(CHANNELS), len(CHANNELS)))
    stream, noise = draw(state.stream)
    reading = quantise_within(
        truth.ravel(), state.offset, state.noise, noise, state.resolution, state.minimum, state.maximum
    )
    return replace(state, stream=stream), reading.reshape(truth.shape)
