"""Where a sensor sits on the machine, from its URDF."""

import numpy as np
import pinocchio as pin

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

IMU_LINK = "imu_link"
"""Link of the inertial measurement unit on every machine."""


def mounting(urdf_xml: str, link: str) -> tuple[FloatArray, FloatArray]:
    """Rotation, shape (3, 3), from a link to base_link, and position of the link in base_link, shape (3,) [m].

    All joints at zero; for a link that no joint moves it holds always.

    Raises:
        InvalidValueError: the URDF has no such link.
    """
    model = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
    if not model.existFrame(link):
        raise InvalidValueError("link of a sensor", link, "a link of the URDF")
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    placement = data.oMf[model.getFrameId(link)]
    return np.array(placement.rotation), np.array(placement.translation)
