"""Current and voltage of motors, each by a channel of its own: /motors/NAME.

Current is that of the winding, voltage that between the terminals, each with noise, offset, range and resolution, see
`bus`; of the temperature of a winding see `temperature`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_contract.heartbeat import status_message
from sojourn_contract.motors import MOTORS, of_motors
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors.bus import ChannelParams
from sojourn_physics.sensors.channels import ChannelsState, initial_channels, read_channels
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/motors",
    "diagnostic_msgs/DiagnosticArray",
    "sensors",
    (),
    5,
    0.5,
    "measured current [A] and voltage [V] of motors: `current JOINT`, `voltage JOINT`; nothing without power",
    (FieldRule("status.values", "A, V"),),
    all_named=True,
)


class MotorSensorParams(SensorParams):
    """Sensors of some motors, all alike: of their current, their voltage or both."""

    kind: str = "motor_sensor"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("current", "voltage")
    hears: ClassVar[tuple[Any, ...]] = (MOTORS,)
    joints: tuple[str, ...] = Field(min_length=1, description="joints whose motors are measured")
    current: ChannelParams | None = Field(default=None, description="channel of each current [A]; none: not measured")
    voltage: ChannelParams | None = Field(default=None, description="channel of each voltage [V]; none: not measured")

    @model_validator(mode="after")
    def _check_channels(self) -> Self:
        if not self.channels:
            raise ValueError("current, voltage: allowed is at least one")
        return self

    @property
    def channels(self) -> dict[str, ChannelParams]:
        """By what they measure."""
        both = {"current": self.current, "voltage": self.voltage}
        return {name: channel for name, channel in both.items() if channel is not None}

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        return (MachinePart("joints", "driven", self.joints),)

    def sensor(self, name: str, site: SensorSite) -> "MotorSensor":
        """The sensors of a machine's motors."""
        return MotorSensor(name, self, site)


@dataclass(frozen=True, eq=False, slots=True)
class MotorReading:
    """Of each motor, (joints,); zero where it is not measured."""

    current: FloatArray
    voltage: FloatArray


@dataclass(frozen=True, eq=False, slots=True)
class MotorMemory:
    """Its channels, by what they measure, and what was told last."""

    channels: dict[str, ChannelsState]
    told: MotorReading


class MotorSensor(Sensor[MotorSensorParams, MotorMemory, MotorReading]):
    """Read where the plant tells currents and voltages."""

    every: ClassVar[int] = ROW.every

    def initial_state(self, truth: Truth) -> MotorMemory:
        params, zeros = self.params, np.zeros(len(self.params.joints))
        channels = {
            of: initial_channels(channel, self.site.seed, [f"{self.name}.{of}.{joint}" for joint in params.joints])
            for of, channel in params.channels.items()
        }
        return self.hear(MotorMemory(channels, MotorReading(zeros, zeros)), truth)

    def step(self, state: MotorMemory, truth: Truth, dt: float) -> tuple[MotorMemory, MotorReading]:
        state = self.hear(state, truth)
        read = {"current": state.told.current, "voltage": state.told.voltage}
        channels = dict(state.channels)
        for of, channel in self.params.channels.items():
            channels[of], read[of] = read_channels(channel, channels[of], read[of])
        return MotorMemory(channels, state.told), MotorReading(**read)

    def step_without_power(self, state: MotorMemory, truth: Truth, dt: float) -> tuple[MotorMemory, None]:
        return self.step(state, truth, dt)[0], None

    def hear(self, state: MotorMemory, truth: Truth) -> MotorMemory:
        message = truth.inputs.get(MOTORS.name)
        if message is None:
            return state
        told = {of: np.array(of_motors(message, of, self.params.joints)) for of in ("current", "voltage")}
        return MotorMemory(state.channels, MotorReading(**told))

    def messages(self, stamp: int, reading: MotorReading | None) -> Iterator[tuple[str, Any]]:
        values: dict[str, str] = {}
        if reading is not None:
            for of in self.params.channels:
                numbers = zip(self.params.joints, getattr(reading, of).tolist(), strict=True)
                values |= {f"{of} {joint}": f"{number:.6g}" for joint, number in numbers}
        yield self.topic, status_message(stamp, self.name, values)
