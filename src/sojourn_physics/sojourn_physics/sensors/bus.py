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

from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream, quantise

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
    """Offsets and random streams of the stores, and the channels' columns."""

    offset: FloatArray
    """Shape (stores, 3), columns as CHANNELS."""
    noise: FloatArray
    """Standard deviations, shape (3,)."""
    resolution: FloatArray
    """Shape (3,)."""
    minimum: FloatArray
    """Shape (3,)."""
    maximum: FloatArray
    """Shape (3,)."""
    streams: tuple[NoiseStream, ...]
    """One for each store."""


def initial_state(params: BusTelemetryParams, seed: int, stores: tuple[str, ...]) -> BusSensorState:
    """Telemetry of the named stores, offsets drawn. A store's numbers depend on its own name only."""
    channels = tuple(getattr(params, name) for name in CHANNELS)
    streams: list[NoiseStream] = []
    offset = np.zeros((len(stores), len(CHANNELS)))
    for place, store in enumerate(stores):
        stream, row = draw(initial_stream(seed, f"bus.{store}", len(CHANNELS)))
        streams.append(stream)
        offset[place] = row * np.array([channel.offset for channel in channels])
    return BusSensorState(
        offset=offset,
        noise=np.array([channel.noise for channel in channels], dtype=np.float64),
        resolution=np.array([channel.resolution for channel in channels], dtype=np.float64),
        minimum=np.array([channel.minimum for channel in channels], dtype=np.float64),
        maximum=np.array([channel.maximum for channel in channels], dtype=np.float64),
        streams=tuple(streams),
    )


def step(state: BusSensorState, truth: FloatArray) -> tuple[BusSensorState, FloatArray]:
    """Measure `truth`, shape (stores, 3), columns as CHANNELS; returns the state and the readings, alike."""
    streams: list[NoiseStream] = []
    reading = np.empty_like(truth)
    for store, stream in enumerate(state.streams):
        after, noise = draw(stream)
        streams.append(after)
        reading[store] = quantise(truth[store], state.offset[store], state.noise, noise, state.resolution)
    reading = np.minimum(np.maximum(reading, state.minimum), state.maximum)
    after_state = BusSensorState(
        state.offset, state.noise, state.resolution, state.minimum, state.maximum, tuple(streams)
    )
    return after_state, reading
