"""Encoders and measured efforts of all joints, by groups: truth of a period in, readings out.

Joints keep the order of the truth; those that no group names are left out. Equations of the encoders are in `encoder`;
joints whose sensor is of another kind are read one by one (`angle_sensor`), each from the stream `angle.JOINT`.
Effort is read through a channel with noise and a resolution, from the random stream `effort.GROUP` of its group
(`noise`), so that a change of one group leaves the numbers of the others alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.sensors import angle_sensor, encoder
from sojourn_physics.sensors.angle_sensor import AngleSensorParams, AngleState
from sojourn_physics.sensors.encoder import EncoderParams
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams, quantise
from sojourn_physics.sensors.params import JointGroupParams
from sojourn_physics.sensors.truth import require_numbers


@dataclass(frozen=True, eq=False, slots=True)
class JointTruth:
    """What is true of n joints at the end of a period, in the order given at the reset."""

    position: FloatArray
    """Shape (n,) [rad]."""
    effort: FloatArray
    """Shape (n,) [N m]."""
    motor_position: FloatArray | None = None
    """Of each joint's motor over its gear, shape (n,) [rad]; None where they all turn as one with their joints."""


@dataclass(frozen=True, eq=False, slots=True)
class Layout:
    """Which joint is read by what; made at the reset."""

    joint_names: tuple[str, ...]
    """The measured joints, in the order of the truth."""
    joint_count: int
    """Joints of the truth, measured or not [1]."""
    measured: IntArray
    """Their places in the truth, shape (k,)."""
    on_motor: NDArray[np.bool_]
    """Whether it is the motor's shaft that is read, shape (k,)."""
    encoders: encoder.EncoderBank
    counted: IntArray
    """Places of the joints with encoders among the measured ones."""
    others: Mapping[int, AngleSensorParams]
    """Sensors of other kinds by the place of their joint among the measured ones."""
    effort_resolution: FloatArray
    """Shape (k,) [N m]."""
    effort_noise: FloatArray
    """Shape (k,) [N m]."""
    effort_offset: FloatArray
    """Zeros, shape (k,) [N m]."""
    effort_noise_places: IntArray
    """Where in a row of the groups' noise that of each measured joint stands, shape (k,)."""


@dataclass(frozen=True, eq=False, slots=True)
class JointSensorState:
    """Everything that encoders and effort channels remember."""

    layout: Layout
    encoders: encoder.EncoderState
    effort_noise: NoiseStream
    """Of all groups, one after another."""
    others: tuple[AngleState, ...] = ()
    """In the order of the layout's."""


@dataclass(frozen=True, eq=False, slots=True)
class JointMeasurement:
    """Of the k measured joints, whose names are in `state.layout.joint_names`."""

    position: FloatArray
    """Shape (k,) [rad]."""
    velocity: FloatArray
    """Shape (k,) [rad/s]."""
    effort: FloatArray
    """Shape (k,) [N m]."""


def initial_state(
    groups: Mapping[str, JointGroupParams], seed: int, joint_names: tuple[str, ...], truth: JointTruth
) -> JointSensorState:
    """Sensors of joints at rest.

    Args:
        groups: by name. joint_names: the joints of the truth, in its order; those of the groups must be among them.

    Raises:
        InvalidValueError: a joint of a group that the machine has not, or a number that is not finite.
    """
    for name, group in groups.items():
        for joint in group.joints:
            if joint not in joint_names:
                raise InvalidValueError(f"joint of sensor group {name}", joint, "one of " + ", ".join(joint_names))
    require_numbers("joint_position", truth.position, (len(joint_names),))
    group_of = {joint: group for group in groups.values() for joint in group.joints}
    names = tuple(name for name in joint_names if name in group_of)
    sensors = [group_of[name].encoder for name in names]
    encoders = {place: sensor for place, sensor in enumerate(sensors) if isinstance(sensor, EncoderParams)}
    layout = Layout(
        joint_names=names,
        joint_count=len(joint_names),
        measured=np.array([joint_names.index(name) for name in names], dtype=np.int64),
        on_motor=np.array([sensor.side == "motor" for sensor in sensors], dtype=bool),
        encoders=encoder.bank(tuple(encoders.values())),
        counted=np.array(list(encoders), dtype=np.int64),
        others={place: sensor for place, sensor in enumerate(sensors) if place not in encoders},
        effort_resolution=np.array([group_of[name].effort_resolution for name in names], dtype=np.float64),
        effort_noise=np.array([group_of[name].effort_noise for name in names], dtype=np.float64),
        effort_offset=np.zeros(len(names)),
        effort_noise_places=np.array([list(group_of).index(name) for name in names], dtype=np.int64),
    )
    seen = _seen(layout, truth)
    return JointSensorState(
        layout=layout,
        encoders=encoder.initial_state(layout.encoders, seen[layout.counted]),
        effort_noise=initial_streams(seed, {f"effort.{name}": len(group.joints) for name, group in groups.items()}),
        others=tuple(
            angle_sensor.initial_state(sensor, seed, f"angle.{names[place]}", float(seen[place]))
            for place, sensor in layout.others.items()
        ),
    )


def step(state: JointSensorState, truth: JointTruth, dt: float) -> tuple[JointSensorState, JointMeasurement]:
    """Read every joint once, a period of `dt` [s] after the last reading.

    Raises:
        InvalidValueError: a truth of the wrong shape or not finite (the error names it), dt not positive.
    """
    layout = state.layout
    require_numbers("truth joint_position", truth.position, (layout.joint_count,))
    require_numbers("truth joint_effort", truth.effort, (layout.joint_count,))
    if not (isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
    seen, others = _seen(layout, truth), state.others
    if others:
        encoders, others, position, velocity = _mixed(state, seen, dt)
    else:
        encoders, position, velocity = encoder.step(layout.encoders, state.encoders, seen, dt)
    effort_noise, noise = draw(state.effort_noise)
    effort = quantise(
        truth.effort[layout.measured],
        layout.effort_offset,
        layout.effort_noise,
        noise[layout.effort_noise_places],
        layout.effort_resolution,
    )
    return JointSensorState(layout, encoders, effort_noise, others), JointMeasurement(position, velocity, effort)


def _mixed(
    state: JointSensorState, seen: FloatArray, dt: float
) -> tuple[encoder.EncoderState, tuple[AngleState, ...], FloatArray, FloatArray]:
    """Encoders and sensors of other kinds: their states, angles [rad] and rates [rad/s], (k,)."""
    layout, after = state.layout, list[AngleState]()
    position, velocity = np.empty_like(seen), np.empty_like(seen)
    encoders, angles, rates = encoder.step(layout.encoders, state.encoders, seen[layout.counted], dt)
    position[layout.counted], velocity[layout.counted] = angles, rates
    for (place, sensor), before in zip(layout.others.items(), state.others, strict=True):
        now, position[place], velocity[place] = angle_sensor.step(sensor, before, float(seen[place]), dt)
        after.append(now)
    return encoders, tuple(after), position, velocity


def _seen(layout: Layout, truth: JointTruth) -> FloatArray:
    """Angles of the shafts that carry the encoders, over the gear (k,) [rad]."""
    seen = truth.position[layout.measured]
    motors = truth.motor_position
    if motors is None:
        return seen
    require_numbers("truth motor_position", motors, (layout.joint_count,))
    return np.where(layout.on_motor, motors[layout.measured], seen)
