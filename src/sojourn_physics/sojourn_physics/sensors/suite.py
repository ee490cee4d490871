"""All sensors of a machine: truth of a period in, measurements out.

Joints keep the order of the truth; those that no group names are left out. Effort is read through a channel
with noise and a resolution. Equations are in `encoder`, `imu`, `bus` and `wrench`; every sensor has its own random
stream (`noise`), named `effort.GROUP`, `imu`, `imu.reset`, `bus.STORE` and `wrist`, so that a change of one sensor
leaves the numbers of the others alone.
"""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.sensors import bus, encoder, imu, wrench
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams, quantise
from sojourn_physics.sensors.params import SensorSuiteParams


@dataclass(frozen=True, eq=False, slots=True)
class SensorTruth:
    """What is true at the end of a period: n joints and m stores, in the order given at the reset."""

    joint_position: FloatArray
    """Shape (n,) [rad]."""
    joint_effort: FloatArray
    """Shape (n,) [N m]."""
    angular_velocity_imu_in_imu: FloatArray
    """Shape (3,) [rad/s]."""
    specific_force_imu_in_imu: FloatArray
    """Acceleration less gravity: + g upward at rest, shape (3,) [m/s^2]."""
    bus_voltage: FloatArray
    """Shape (m,) [V]."""
    bus_current: FloatArray
    """Out of the store positive, shape (m,) [A]."""
    bus_temperature: FloatArray
    """Shape (m,) [K]."""
    wrist_wrench: FloatArray | None = None
    """On the wrist's sensor in its frame, shape (6,) [N], [N m]; None where nobody tells it."""
    motor_position: FloatArray | None = None
    """Of each joint's motor over its gear, shape (n,) [rad]; None where they all turn as one with their joints."""


@dataclass(frozen=True, eq=False, slots=True)
class Layout:
    """Which joint is read by what; made at the reset."""

    joint_names: tuple[str, ...]
    """The measured joints, in the order of the truth."""
    stores: tuple[str, ...]
    """The energy stores."""
    joint_count: int
    """Joints of the truth, measured or not [1]."""
    measured: IntArray
    """Their places in the truth, shape (k,)."""
    encoders: encoder.EncoderBank
    effort_resolution: FloatArray
    """Shape (k,) [N m]."""
    effort_noise: FloatArray
    """Shape (k,) [N m]."""
    effort_offset: FloatArray
    """Zeros, shape (k,) [N m]."""
    effort_noise_places: IntArray
    """Where in a row of the groups' noise that of each measured joint stands, shape (k,)."""


@dataclass(frozen=True, eq=False, slots=True)
class SensorSuiteState:
    """Everything the sensors remember; a value that may be copied and stepped again."""

    layout: Layout
    encoders: encoder.EncoderState
    effort_noise: NoiseStream
    """Of all groups, one after another."""
    imu: imu.ImuState
    bus: bus.BusSensorState
    wrist: wrench.WrenchSensorState | None
    """None for a machine without the sensor."""


@dataclass(frozen=True, eq=False, slots=True)
class SensorMeasurements:
    """Readings of a period. k measured joints (names in `state.layout.joint_names`), m stores."""

    joint_position: FloatArray
    """Shape (k,) [rad]."""
    joint_velocity: FloatArray
    """Shape (k,) [rad/s]."""
    joint_effort: FloatArray
    """Shape (k,) [N m]."""
    imu: imu.ImuReading
    bus_voltage: FloatArray
    """Shape (m,) [V]."""
    bus_current: FloatArray
    """Out of the store positive, shape (m,) [A]."""
    bus_temperature: FloatArray
    """Shape (m,) [K]."""
    wrist_wrench: FloatArray | None = None
    """Shape (6,) [N], [N m]; None where it is not measured."""


def initial_state(
    params: SensorSuiteParams,
    seed: int,
    joint_names: tuple[str, ...],
    joint_position: FloatArray,
    stores: tuple[str, ...],
    orientation_imu_in_world: FloatArray,
    gravity: float,
    motor_position: FloatArray | None = None,
) -> SensorSuiteState:
    """Sensors at the start of a run.

    Args:
        joint_names: the joints of the truth, in its order; those of the groups must be among them.
        joint_position: at the start, shape (n,) [rad].
        stores: names of the energy stores.
        orientation_imu_in_world: quaternion x y z w, shape (4,); only its heading is used.
        gravity: on the body, for the levelling of the IMU [m/s^2].
        motor_position: as in SensorTruth.

    Raises:
        InvalidValueError: a joint of a group that the machine has not, or a number that is not finite.
    """
    groups = list(params.joint_groups.items())
    for name, group in groups:
        for joint in group.joints:
            if joint not in joint_names:
                raise InvalidValueError(f"joint of sensor group {name}", joint, "one of " + ", ".join(joint_names))
    _require_shape("joint_position", joint_position, (len(joint_names),))
    _require_shape("orientation_imu_in_world", orientation_imu_in_world, (4,))
    group_of = {joint: group for _, group in groups for joint in group.joints}
    names = tuple(name for name in joint_names if name in group_of)
    measured = np.array([joint_names.index(name) for name in names], dtype=np.int64)
    layout = Layout(
        joint_names=names,
        stores=tuple(stores),
        joint_count=len(joint_names),
        measured=measured,
        encoders=encoder.bank(tuple(group_of[name].encoder for name in names)),
        effort_resolution=np.array([group_of[name].effort_resolution for name in names], dtype=np.float64),
        effort_noise=np.array([group_of[name].effort_noise for name in names], dtype=np.float64),
        effort_offset=np.zeros(len(names)),
        effort_noise_places=np.array([list(group_of).index(name) for name in names], dtype=np.int64),
    )
    return SensorSuiteState(
        layout=layout,
        encoders=encoder.initial_state(layout.encoders, _seen(layout, joint_position, motor_position)),
        effort_noise=initial_streams(seed, {f"effort.{name}": len(group.joints) for name, group in groups}),
        imu=imu.initial_state(params.imu, seed, imu.heading_of(orientation_imu_in_world), gravity),
        bus=bus.initial_state(params.bus, seed, tuple(stores)),
        wrist=None if params.wrist is None else wrench.initial_state(params.wrist, seed),
    )


def warm_up(params: SensorSuiteParams, gravity: float) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
    joints = tuple(joint for group in params.joint_groups.values() for joint in group.joints)
    zeros, one = np.zeros(len(joints)), np.ones(1)
    still, up = np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.0, 0.0, gravity])
    state = initial_state(params, 0, joints, zeros, ("store",), still, gravity)
    truth = SensorTruth(zeros, zeros, np.zeros(3), up, 28.0 * one, one, 290.0 * one, np.zeros(wrench.AXES))
    for _ in range(2):  # the first finds the attitude, the others follow it
        state, _ = step(params, state, truth, 0.02)


def step(
    params: SensorSuiteParams, state: SensorSuiteState, truth: SensorTruth, dt: float
) -> tuple[SensorSuiteState, SensorMeasurements]:
    """Read every sensor once, a period of `dt` [s] after the last reading.

    Raises:
        InvalidValueError: a truth of the wrong shape or not finite (the error names it), dt not positive.
    """
    layout = state.layout
    _require_truth(layout, truth)
    if not (isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")

    seen = _seen(layout, truth.joint_position, truth.motor_position)
    encoders, position, velocity = encoder.step(layout.encoders, state.encoders, seen, dt)
    effort_noise, noise = draw(state.effort_noise)
    effort = quantise(
        truth.joint_effort[layout.measured],
        layout.effort_offset,
        layout.effort_noise,
        noise[layout.effort_noise_places],
        layout.effort_resolution,
    )

    imu_state, imu_reading = imu.step(
        params.imu, state.imu, truth.angular_velocity_imu_in_imu, truth.specific_force_imu_in_imu, dt
    )
    electrical = np.empty((len(layout.stores), 3))
    electrical[:, 0], electrical[:, 1] = truth.bus_voltage, truth.bus_current
    electrical[:, 2] = truth.bus_temperature
    bus_state, bus_reading = bus.step(state.bus, electrical)
    wrist_state, wrist_reading = state.wrist, None
    if state.wrist is not None and truth.wrist_wrench is not None:
        wrist_state, wrist_reading = wrench.step(state.wrist, truth.wrist_wrench)
    after_state = SensorSuiteState(layout, encoders, effort_noise, imu_state, bus_state, wrist_state)
    return after_state, SensorMeasurements(
        joint_position=position,
        joint_velocity=velocity,
        joint_effort=effort,
        imu=imu_reading,
        bus_voltage=bus_reading[:, 0].copy(),
        bus_current=bus_reading[:, 1].copy(),
        bus_temperature=bus_reading[:, 2].copy(),
        wrist_wrench=wrist_reading,
    )


def _seen(layout: Layout, joints: FloatArray, motors: FloatArray | None) -> FloatArray:
    """Angles of the shafts that carry the encoders, over the gear (k,) [rad]."""
    seen = joints[layout.measured]
    if motors is None:
        return seen
    _require_shape("motor_position", motors, (layout.joint_count,))
    return np.where(layout.encoders.on_motor, motors[layout.measured], seen)


def _require_truth(layout: Layout, truth: SensorTruth) -> None:
    joints, stores = (layout.joint_count,), (len(layout.stores),)
    _require_shape("truth joint_position", truth.joint_position, joints)
    _require_shape("truth joint_effort", truth.joint_effort, joints)
    _require_shape("truth angular_velocity_imu_in_imu", truth.angular_velocity_imu_in_imu, (3,))
    _require_shape("truth specific_force_imu_in_imu", truth.specific_force_imu_in_imu, (3,))
    _require_shape("truth bus_voltage", truth.bus_voltage, stores)
    _require_shape("truth bus_current", truth.bus_current, stores)
    _require_shape("truth bus_temperature", truth.bus_temperature, stores)
    if truth.wrist_wrench is not None:
        _require_shape("truth wrist_wrench", truth.wrist_wrench, (wrench.AXES,))


def _require_shape(name: str, value: FloatArray, shape: tuple[int, ...]) -> None:
    if value.shape != shape:
        raise InvalidValueError(f"shape of {name}", value.shape, str(shape))
    # A sum is not finite where one of its numbers is not, and may be too large where all are.
    if not isfinite(sum(value.tolist())) and not np.isfinite(value).all():
        raise InvalidValueError(name, value.tolist(), "finite numbers")
