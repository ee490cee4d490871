"""The load on the force sensor at an arm's wrist: what all that hangs on it does to the arm.

    w = -(Σ I a + v × I v) + Σ w_contact,   a relative to free fall

over the bodies beyond the sensor: weight and inertia by recursive Newton-Euler (Featherstone 2008, table 5.1;
Pinocchio's rnea), and the contacts of those bodies with the ground. Force and moment are those on the arm, at the
origin of the sensor's link and in its frame.

The acceleration is the change of velocity over the control period, the contact forces are means over it: a reading is
the mean of a period, as an integrating converter gives it.
"""

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import FORCE, PLACE
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray


class WristLoad:
    """Finds the load on the sensor of one machine; keeps no state of the run.

    Args:
        multibody: the machine. link: that hangs on the sensor, at the joint that carries it.
        bodies: (contacts,) index of the joint that carries each contact.

    Raises:
        InvalidValueError: no such link, or one that no joint of an arm carries.
    """

    def __init__(self, multibody: pin.Model, link: str, bodies: IntArray) -> None:
        if not multibody.existFrame(link):
            raise InvalidValueError("wrench_sensor_link", link, "a link of the URDF")
        frame = multibody.frames[multibody.getFrameId(link)]
        self._joint = int(frame.parentJoint)
        if self._joint < 2 or not frame.placement.isIdentity(1e-9):
            raise InvalidValueError("wrench_sensor_link", link, "a link whose frame is that of the joint it hangs on")
        self._multibody = multibody
        self._data = multibody.createData()
        beyond = set(multibody.subtrees[self._joint])
        self.contacts: IntArray = np.array([i for i, body in enumerate(bodies) if int(body) in beyond], dtype=np.int64)
        """Contacts with the ground that act beyond the sensor."""

    def at_rest(self, configuration: FloatArray, report: FloatArray) -> FloatArray:
        """As `wrench`, of a machine that stands still."""
        still = np.zeros(self._multibody.nv)
        return self.wrench(configuration, still, still, report)

    def wrench(
        self, configuration: FloatArray, velocity: FloatArray, acceleration: FloatArray, report: FloatArray
    ) -> FloatArray:
        """Force and moment (6,) [N], [N m].

        Args:
            configuration, velocity, acceleration: of the machine, (nq,), (nv,), (nv,).
            report: (contacts, REPORT_COLUMNS), forces as means over the period.
        """
        pin.rnea(self._multibody, self._data, configuration, velocity, acceleration)
        load = -np.array(self._data.f[self._joint].vector)
        touching = report[self.contacts]
        if np.count_nonzero(touching[:, FORCE]):  # an arm seldom touches anything
            pin.updateGlobalPlacements(self._multibody, self._data)
            placement = self._data.oMi[self._joint]
            for contact in touching:
                force = placement.rotation.T @ contact[FORCE]
                load[:3] += force
                load[3:] += np.cross(placement.actInv(contact[PLACE]), force)
        return load
