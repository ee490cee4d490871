"""Equations of motion of a machine that nothing holds, in a map that turns with its orbit.

Pinocchio's equations hold in axes that do not turn. At each instant those of map are such axes, in which the base has
besides its twist v in map that of map itself, and with it its rate of change, in the axes of the base:

    w  = [R^T (W x p), R^T W],      v_stars = v + w
    w' = [w_v x o + w_o x v_v,  w_o x o]         v = (v_v, o), R and p the base's attitude and place in map

    bias = RNEA(q, v_stars, w') - torque of the tide about the centre of mass

which is exact: centrifugal, Coriolis and gyroscopic forces are all in it. The tide is that of the centre of mass on
every link, and on the base its torque on the machine as it stands, 3 n^2 z x I z (Wertz 1978, section 17.2). Left out
is what the tide does within the machine, some 1e-6 m/s2 a metre.
"""

import numpy as np
import pinocchio as pin

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.tide import TidalField

OUTWARD = np.array((0.0, 0.0, 1.0))


def orbital_bias(
    multibody: pin.Model, data: pin.Data, field: TidalField, configuration: FloatArray, velocity: FloatArray
) -> FloatArray:
    """Bias forces of a machine afloat, (nv,): what `pin.nonLinearEffects` has for one in axes that do not turn.

    Args:
        data: with the machine's composite inertia, which `pin.crba` in axes of the world leaves there.
        configuration, velocity: in map, (nq,), (nv,).
    """
    rotation = pin.Quaternion(configuration[3:7]).toRotationMatrix()
    composite, turning = data.oYcrb[1], field.turning
    w_linear = rotation.T @ np.cross(turning, configuration[:3])
    w_angular = rotation.T @ turning
    against_stars, change = velocity.copy(), np.zeros(len(velocity))
    against_stars[:3] += w_linear
    against_stars[3:6] += w_angular
    change[:3] = np.cross(w_linear, velocity[3:6]) + np.cross(w_angular, velocity[:3])
    change[3:6] = np.cross(w_angular, velocity[3:6])
    multibody.gravity.linear = field.tide(composite.lever)
    bias = np.array(pin.rnea(multibody, data, configuration, against_stars, change))
    torque = 3.0 * field.rate**2 * np.cross(OUTWARD, composite.inertia @ OUTWARD)
    bias[3:6] -= rotation.T @ torque
    return bias
