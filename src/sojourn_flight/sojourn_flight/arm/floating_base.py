"""How a base that floats free gives way under its arm.

    H_b v_b + H_bm q' = 0,    v_b = -H_b^-1 H_bm q'          total momentum, linear and angular, is zero and stays so

(Umetani & Yoshida 1989, IEEE Trans. Robotics and Automation 5:303; v_b the twist of the base in its own axes, H_b and
H_bm blocks of the mass matrix on a free base.) Integrated along a way of the joints it foretells where the base comes
to; how fast the way is gone does not matter. Looking back, the place of the base follows from the common centre of
mass, which stays where it is, once its turn has been measured:

    p = c(q_then) - R c(q_now)                                in the axes of then, c the centre of mass in the base

Range: no force from outside, and none from thrusters or wheels; masses and inertias are believed as the URDF has them.
"""

import math

import numpy as np
import pinocchio as pin

from sojourn_flight.arm.params import ArmParams
from sojourn_machine.params import FloatArray

BASE_RATES = 6
LONGEST_STEP = 0.05
"""Of a joint in one step of the integration [rad or m]: the base is then foretold within 1e-4 of its way."""


def base_reaction(model: pin.Model, data: pin.Data, configuration: FloatArray) -> FloatArray:
    """Twist of the base in its own axes for each joint's rate, linear first, (6, n).

    Args:
        model: with a free-flying base as its first joint. configuration: of base and joints, (nq,).
    """
    upper = np.triu(pin.crba(model, data, configuration, pin.Convention.WORLD))
    of_base = upper[:BASE_RATES, :BASE_RATES]
    return np.asarray(-np.linalg.solve(of_base + np.triu(of_base, 1).T, upper[:BASE_RATES, BASE_RATES:]))


class FloatingBase:
    """A machine whose arm alone moves, on a base that nothing holds."""

    def __init__(self, urdf_xml: str, params: ArmParams) -> None:
        full = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
        posture = pin.neutral(full)
        for name, value in params.locked_positions.items():
            posture[full.joints[full.getJointId(name)].idx_q] = value
        locked = [i for i in range(2, full.njoints) if full.names[i] not in params.joint_names]
        self._model = pin.buildReducedModel(full, locked, posture)
        self._data = self._model.createData()

    def reaction(self, joints: FloatArray) -> FloatArray:
        """Twist of the base for each joint's rate at positions (n,): (6, n)."""
        return base_reaction(self._model, self._data, self._at(joints))

    def foretold(self, joints: FloatArray, target: FloatArray) -> pin.SE3:
        """Where the base comes to, in its frame of now, while the joints go straight from (n,) to (n,)."""
        way = target - joints
        steps = max(1, math.ceil(float(np.abs(way).max()) / LONGEST_STEP))
        base, part = pin.SE3.Identity(), way / steps
        for number in range(steps):
            base = base * pin.exp6(self.reaction(joints + (number + 0.5) * part) @ part)
        return base

    def given_way(self, joints_then: FloatArray, joints_now: FloatArray, turn: FloatArray) -> pin.SE3:
        """Where the base is in its frame of then, turned by a rotation (3, 3) since."""
        return pin.SE3(turn, self._centre(joints_then) - turn @ self._centre(joints_now))

    def _at(self, joints: FloatArray) -> FloatArray:
        configuration = pin.neutral(self._model)
        configuration[BASE_RATES + 1 :] = joints
        return np.asarray(configuration)

    def _centre(self, joints: FloatArray) -> FloatArray:
        """Of all mass, in the base, (3,) [m]."""
        return np.array(pin.centerOfMass(self._model, self._data, self._at(joints)))
