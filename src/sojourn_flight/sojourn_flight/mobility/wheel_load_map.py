"""How much of its weight a machine puts on each wheel, by its pitch and roll: what the drive expects of the loads.

Every wheel pulls by the same part of its load, as wheels at one slip do, so that the force of the ground on each is
straight up: f_i e, e the unit vector upwards in base_link. With Z the motions that passive joints (rockers, bogies) and
their couplings leave free, J_i the Jacobian of the contact and g the generalised gravity (principle of virtual work),

    sum_i (Z^T J_i^T e) f_i = Z^T g,        of least sum f_i^2 where wheels are more than equations,

and N_i = f_i e_z, normal to the body's plane. It is linearised about level ground:

    N_i = m_i0 cos(roll) cos(pitch) + m_i1 sin(pitch) + m_i2 sin(roll) cos(pitch)

Source: Lindemann and Voorhees 2005, IEEE SMC (equalising of the rocker-bogie); Genta and Genta 2017, sec. 5.3. Range:
slopes up to about 20 deg; motors hold their joints where they are at zero; inertia of a moving machine left out.
"""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray

TILT = 0.1
"""Sine of the tilt over which the map is linearised [-]."""
NOT_FREE = 1e-9
"""Singular value below which a coupling says nothing, over the largest."""


def wheel_load_map(
    urdf_xml: str, machine: MachineParams, gravity: float, angles: Mapping[str, float] | None = None
) -> FloatArray:
    """m, shape (wheels, 3) [N].

    Args:
        urdf_xml: text of the URDF. machine: its wheels, drives and couplings. gravity: [m/s^2].
        angles: of joints with limits, as of an arm, by name; the others are at 0 [rad].
    """
    model = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
    data = model.createData()
    configuration = pin.neutral(model)
    for name, angle in (angles or {}).items():
        configuration[model.joints[model.getJointId(name)].idx_q] = angle
    pin.computeJointJacobians(model, data, configuration)
    free = free_motions(model, machine)
    contacts = []
    for wheel in machine.wheels:
        joint = model.getJointId(wheel.joint)
        jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        contacts.append(jacobian[:3] + pin.skew(np.array((0.0, 0.0, wheel.radius))) @ jacobian[3:])

    def loads(up: FloatArray) -> FloatArray:
        model.gravity.linear = -gravity * up
        weight = pin.computeGeneralizedGravity(model, data, configuration)
        columns = np.array([free.T @ (jacobian.T @ up) for jacobian in contacts]).T
        return np.asarray(np.linalg.lstsq(columns, free.T @ weight, rcond=None)[0] * up[2])

    level, rest = loads(np.array((0.0, 0.0, 1.0))), np.sqrt(1.0 - TILT**2)
    # nose down (pitch) the weight goes forward: up leans backward, as seen from the body
    columns = [level]
    for lean in (np.array((-TILT, 0.0, rest)), np.array((0.0, TILT, rest))):
        against = lean * (-1.0, -1.0, 1.0)
        columns.append((loads(lean) - loads(against)) / (2.0 * TILT))
    return np.ascontiguousarray(np.array(columns).T)


def free_motions(model: pin.Model, machine: MachineParams) -> FloatArray:
    """Z, shape (nv, free motions): those of the body and of passive joints, as their couplings leave them."""
    driven = {joint for drive in machine.drives for joint in drive.joints}
    names = list(model.names)[2:]
    passive = [name for name in names if name not in driven]
    columns = [model.joints[model.getJointId(name)].idx_v for name in passive]
    rows = np.zeros((len(machine.couplings), len(passive)))
    for row, coupling in zip(rows, machine.couplings, strict=True):
        row[passive.index(coupling.first)] = 1.0
        row[passive.index(coupling.second)] = coupling.ratio
    _, values, directions = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(values > NOT_FREE * values.max())) if values.size else 0
    left = directions[rank:]
    free = np.zeros((model.nv, 6 + len(left)))
    free[:6, :6] = np.eye(6)
    free[columns, 6:] = left.T
    return free
