"""Hours of an IMU at rest: what `sojourn_physics.sensors.imu` reads, by its own kernel, without its attitude."""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.imu import ImuParams, initial_state
from sojourn_physics.sensors.imu_kernels import read_triads
from sojourn_physics.sensors.noise import draw_rows


def rest_record(params: ImuParams, seed: int, gravity: float, dt: float, count: int) -> FloatArray:
    """Readings of an IMU that stands level, the ones that `imu.step` gives.

    Args:
        gravity: [m/s^2]. dt: time of a reading [s]. count: of readings.

    Returns:
        angular velocity [rad/s] and specific force [m/s^2], shape (count, 6).

    Raises:
        InvalidValueError: as `imu.initial_state`.
    """
    state = initial_state(params, seed, 0.0, gravity)
    truth = np.array((0.0, 0.0, 0.0, 0.0, 0.0, gravity))
    readings, stream, memory, done = np.empty((count, 6)), state.stream, state.memory, 0
    while done < count:
        stream, noise = draw_rows(stream)
        part = readings[done : done + len(noise)]
        memory = _read(state.axes, memory, truth, dt, noise, part)
        done += len(part)
    return readings


@njit(cache=True)
def _read(
    axes: FloatArray, memory: FloatArray, truth: FloatArray, dt: float, noise: FloatArray, readings: FloatArray
) -> FloatArray:
    for row in range(readings.shape[0]):
        readings[row], memory = read_triads(axes, memory, truth, 0.0, dt, noise[row])
    return memory
