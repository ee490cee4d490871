"""What the wheels of a rover carry while its arm hangs out and presses: whether it is about to tip over.

Statics by the principle of virtual work: with Z the motions that passive joints and their couplings leave free, J_i the
Jacobian of the contact of wheel i, J_t that of the tip, g the generalised gravity and F the force of the ground on the
tip,

    sum_i Z^T J_i^T f_i = Z^T (g - J_t^T F),

of all f_i those of least  sum_i (n_i^2 + c t_i^2)  with n_i along the normal of the ground and t_i along it: wheels do
not push against one another (Castigliano; see `vehicle/wheel_loads`). A wheel whose n_i has gone to zero is about to be
lifted. It is the static margin against tipping over (Papadopoulos & Rey 1996, IEEE ICRA), by the wheels of a suspension
and not by the polygon of a rigid one.

What is known of the machine is its URDF, the joints as measured, gravity from the attitude. Assumptions: at rest;
motors hold their joints; the ground under the wheels is square to the z axis of base_link; a machine that stands fast,
or lifts a wheel already, is not judged.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sojourn_flight.mobility.wheel_load_map import free_motions
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray

_SOFTER_ALONG = 1.0e4
"""c [-]"""


@dataclass(frozen=True, slots=True, eq=False)
class FootingLoads:
    """Normal forces of the wheels as a linear function of the force on the tip: n = rest + per_force F."""

    rest: FloatArray  # (wheels,) [N]
    per_force: FloatArray  # (wheels, 3) [N/N], of a force in base_link
    names: tuple[str, ...]  # of the wheels

    def least_share(self, force: FloatArray) -> tuple[int, float]:
        """The wheel that keeps least of its load under a force (3,) [N] on the tip, and the share of it that it keeps;
        1 where one is lifted without any force.
        """
        if np.any(self.rest <= 0.0):
            return 0, 1.0
        shares = 1.0 + self.per_force @ force / self.rest
        wheel = int(np.argmin(shares))
        return wheel, float(shares[wheel])


class Footing:
    """Finds the loads of one machine.

    Args:
        urdf_xml: the machine. machine: its wheels, drives and couplings.
        joints: of the arm. base_link, tip_link: of it.
    """

    def __init__(
        self, urdf_xml: str, machine: MachineParams, joints: Sequence[str], base_link: str, tip_link: str
    ) -> None:
        self._model = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
        self._data = self._model.createData()
        self._free = free_motions(self._model, machine)
        joints_and_radii = [(self._model.getJointId(wheel.joint), wheel.radius) for wheel in machine.wheels]
        self._wheels = [(joint, np.array([0.0, 0.0, radius])) for joint, radius in joints_and_radii]
        self._stiff = np.tile([_SOFTER_ALONG**-0.5, _SOFTER_ALONG**-0.5, 1.0], len(machine.wheels))
        self._arm = [self._model.joints[self._model.getJointId(name)].idx_q for name in joints]
        self._base, self._tip = self._model.getFrameId(base_link), self._model.getFrameId(tip_link)
        self._names = tuple(wheel.name for wheel in machine.wheels)
        joints_of = zip(self._model.names, self._model.joints, strict=True)
        self._places = {name: joint.idx_q for name, joint in joints_of if joint.nq == 1}

    def loads(self, joints: Mapping[str, float], positions: FloatArray, gravity: FloatArray) -> FootingLoads:
        """Loads with the joints of the suspension as they are measured [rad or m], others at zero, and the arm at
        `positions` (n,), under `gravity` in base_link (3,) [m/s2].
        """
        model, data, q = self._model, self._data, pin.neutral(self._model)
        for name, value in joints.items():
            place = self._places.get(name)
            if place is not None:
                q[place] = value
        q[self._arm] = positions
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        turned = data.oMf[self._base].rotation
        model.gravity.linear = turned @ gravity
        weight = pin.computeGeneralizedGravity(model, data, q)
        columns = []
        for joint, down in self._wheels:
            jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
            below = jacobian[:3] + pin.skew(turned @ down) @ jacobian[3:]
            columns.append(self._free.T @ (below.T @ turned))
        to_tip = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)[:3]
        asked = np.column_stack([weight, -to_tip.T @ turned])
        stiff = self._stiff
        found = stiff[:, None] * (np.linalg.pinv(np.hstack(columns) * stiff) @ (self._free.T @ asked))
        normal = found[2::3]
        return FootingLoads(normal[:, 0], normal[:, 1:], self._names)
