"""What tells the angle of a joint, as a machine's file says it: a kind by its name, with its own parameters.

The default, `encoder`, is read for all joints at once (`encoder.step`). Every other kind is read joint by joint here: a
class with its parameters, `begin` and `read`, registered by an entry point of the group `sojourn.angle_sensors`. All
angles are those of the shaft that carries the sensor over its gear [rad]. A kind that tells no rate has that of its
angles over the last w periods: (a_k - a_(k-w)) / (w dt), as an encoder has.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeAlias

from pydantic import Field, SerializeAsAny, model_validator

from sojourn_machine.choice import kinds_of
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.registry import Registry
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream

ANGLE_SENSORS: "Registry[type[AngleSensorParams]]" = Registry("sojourn.angle_sensors", "kind of angle sensor")
"""Parameter sets of the kinds of angle sensors, by their names."""
TURN = 2.0 * math.pi
"""[rad]"""


class AngleTold(NamedTuple):
    """What a sensor says in a period, and remembers."""

    memory: Any
    angle: float
    """[rad]"""
    rate: float | None = None
    """[rad/s]; None: that of its angles."""


class AngleSensorParams(Params):
    """One angle sensor of each joint of a group. Each kind has a subclass, its name the default of `kind`."""

    kind: str = Field(description="kind of angle sensor")
    side: Literal["motor", "output"] = Field(description="shaft that carries the sensor")
    gear_ratio: float = Field(
        default=1.0, ge=1.0, le=1e5, description="turns of the sensor's shaft for one turn of the joint [1]"
    )
    rate_window: int = Field(default=1, ge=1, le=50, description="periods over which the rate is taken [1]")
    drawn: ClassVar[int] = 1
    """Standard normal numbers that each begins with, and that each reading takes."""

    @model_validator(mode="after")
    def _check_side(self) -> Self:
        if self.side == "output" and self.gear_ratio != 1.0:
            raise ValueError(f"gear_ratio = {self.gear_ratio}: allowed is 1 for an encoder on the output side")
        return self

    def begin(self, angle: float, drawn: FloatArray) -> Any:
        """What it remembers of its errors, (drawn,) standard normal, at the angle of the start [rad]."""
        raise NotImplementedError

    def read(self, memory: Any, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        """A reading of an angle [rad], `dt` [s] after the last one, with noise (drawn,); `memory` is not changed."""
        raise NotImplementedError


AngleSensor: TypeAlias = Annotated[SerializeAsAny[AngleSensorParams], *kinds_of(ANGLE_SENSORS, "kind", "encoder")]
"""Of a file; one that names no kind is an encoder."""


@dataclass(frozen=True, eq=False, slots=True)
class AngleState:
    """Of the sensor of one joint."""

    memory: Any
    told: tuple[float, ...]
    """Angles, newest first, at most `rate_window` of them [rad]."""
    stream: NoiseStream


def initial_state(params: AngleSensorParams, seed: int, name: str, angle: float) -> AngleState:
    """A joint at rest at an angle [rad], whose sensor draws its errors from the stream of `name`."""
    stream, row = draw(initial_stream(seed, name, params.drawn))
    memory = params.begin(angle, row)
    memory, told, _ = params.read(memory, angle, 0.0 * row, 0.0)
    return AngleState(memory, (told,), stream)


def step(params: AngleSensorParams, state: AngleState, angle: float, dt: float) -> tuple[AngleState, float, float]:
    """A reading of a joint at an angle [rad], `dt` [s] after the last one: the state, angle [rad] and rate [rad/s]."""
    stream, noise = draw(state.stream)
    memory, told, rate = params.read(state.memory, angle, noise, dt)
    if rate is None:
        rate = (told - state.told[-1]) / (len(state.told) * dt)
    return AngleState(memory, (told, *state.told)[: params.rate_window], stream), told, rate
