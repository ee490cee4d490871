"""Joint efforts that the reference motion needs, on a tilted body and under any gravity.

Recursive Newton-Euler (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1; Pinocchio's rnea):
    tau = M(q) qdd + c(q, qd) + g(q) + friction,
    friction = coulomb tanh(qd / v0) + viscous qd   of the reference, so that it is smooth and zero at rest.

Gravity enters as a vector in base_link, from the attitude that the IMU reports. Reflected rotor inertia
adds to the diagonal of M. Assumption: the base stands still or moves slowly (its own acceleration is not
fed forward).
"""

import math
from functools import lru_cache

import numpy as np

from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import ArmDriveParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


def gravity_in_body(quaternion_xyzw: FloatArray, gravity: float) -> FloatArray:
    """Gravity vector in a body's frame (3,) [m/s2] from the attitude of that body in a z-up world.

    Args:
        quaternion_xyzw: orientation of the body in the world (4,), as in sensor_msgs/Imu; near unit length.
        gravity: surface gravity of the body, positive [m/s2].

    Raises:
        InvalidValueError: numbers not finite, quaternion not of unit length, gravity negative.
    """
    quaternion = np.asarray(quaternion_xyzw, dtype=np.float64)
    if quaternion.shape != (4,) or not all(map(math.isfinite, quaternion.tolist())):
        raise InvalidValueError("orientation", quaternion.tolist(), "four finite numbers x, y, z, w")
    length = math.sqrt(quaternion.dot(quaternion))
    if abs(length - 1.0) > 0.01:
        raise InvalidValueError("orientation", quaternion.tolist(), "a unit quaternion")
    if not (math.isfinite(gravity) and gravity >= 0.0):
        raise InvalidValueError("gravity", gravity, "a finite number, zero or more [m/s2]")
    x, y, z, w = (quaternion / length).tolist()
    # Third row of the rotation base -> world is world's z axis seen in the body.
    up_in_body = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    return np.array([-gravity * up for up in up_in_body])


@lru_cache(maxsize=32)
def _array(values: tuple[float, ...]) -> FloatArray:
    """Of a parameter, made once; never written to."""
    return np.array(values)


def friction_effort(params: ArmDriveParams, velocities: FloatArray) -> FloatArray:
    """Friction to be overcome at reference `velocities` (n,): efforts (n,) [N m or N]."""
    effort = np.zeros(velocities.shape[0])
    if params.coulomb_friction:
        effort += _array(params.coulomb_friction) * np.tanh(velocities / params.friction_velocity)
    if params.viscous_friction:
        effort += _array(params.viscous_friction) * velocities
    return effort


def feedforward_effort(
    params: ArmDriveParams, model: ArmModel, velocities: FloatArray, rigid_efforts: FloatArray
) -> FloatArray:
    """Inverse dynamics (`dynamics.rigid_effort`, (n,)) and friction of a reference with these velocities (n,), cut to
    the URDF's effort limits: (n,) [N m or N].
    """
    effort = rigid_efforts + friction_effort(params, velocities)
    return np.minimum(np.maximum(effort, -model.max_effort), model.max_effort)
