"""Several channels of telemetry that are all alike, each with an offset and noise of its own: see `bus`."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.bus import ChannelParams
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams, quantise_within


@dataclass(frozen=True, eq=False, slots=True)
class ChannelsState:
    """Offsets, (n,), and the noise to come."""

    offset: FloatArray
    stream: NoiseStream


def initial_channels(params: ChannelParams, seed: int, names: Sequence[str]) -> ChannelsState:
    """Of channels with streams of these names: one more changes nobody else's noise."""
    stream, row = draw(initial_streams(seed, dict.fromkeys(names, 1)))
    return ChannelsState(row * params.offset, stream)


def read_channels(params: ChannelParams, state: ChannelsState, true: FloatArray) -> tuple[ChannelsState, FloatArray]:
    """One reading of each, (n,): the state after it, and what is read of the true values."""
    stream, noise = draw(state.stream)
    numbers = (params.noise, params.resolution, params.minimum, params.maximum)
    sigma, resolution, least, most = np.repeat(np.array(numbers)[:, np.newaxis], len(true), axis=1)
    return replace(state, stream=stream), quantise_within(true, state.offset, sigma, noise, resolution, least, most)
