"""The plane of the ground in base_link, as a machine knows it that feels only its own joints.

Wheels stand on the ground; so it is taken for the plane that comes nearest (least squares) to their lowest points, with
the suspension as its joints are measured. On a slope the rover tilts with the plane and nothing changes. What it does
not know: how far wheels have sunk in (the ground is higher by that), and ground ahead that rises or falls.

Range: three wheels or more that are not in one line; tilts of the suspension to some 30 degrees (the lowest point of a
wheel is taken along the z axis of base_link).
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio

from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

_IN_LINE = 1.0e-3
"""Second moment of the wheels about a line, in shares of that along it, below which they carry no plane [-]."""


class GroundUnderWheels:
    """Finds the plane under a machine.

    Args:
        urdf_xml: the machine. wheels: joint and radius [m] of each. base_link: link in whose frame the plane is given.

    Raises:
        InvalidValueError: a wheel's joint, or base_link, that the URDF has not.
    """

    def __init__(self, urdf_xml: str, wheels: Sequence[tuple[str, float]], base_link: str = "base_link") -> None:
        self._model = pinocchio.buildModelFromXML(urdf_xml)
        self._data = self._model.createData()
        if not self._model.existFrame(base_link):
            raise InvalidValueError("base_link", base_link, "a link of the URDF")
        for joint, _ in wheels:
            if not self._model.existJointName(joint):
                raise InvalidValueError("joint of a wheel", joint, "a joint of the URDF")
        self._base = self._model.getFrameId(base_link)
        self._wheels = [(self._model.getJointId(joint), radius) for joint, radius in wheels]

    def plane(self, joints: Mapping[str, float]) -> GroundPlane | None:
        """The plane with joints at these positions [rad or m] and others at zero; None where wheels carry none."""
        q = pinocchio.neutral(self._model)
        for name, value in joints.items():
            if self._model.existJointName(name):
                joint = self._model.joints[self._model.getJointId(name)]
                if joint.nq == 1:
                    q[joint.idx_q] = value
        pinocchio.framesForwardKinematics(self._model, self._data, q)
        base = self._data.oMf[self._base]
        points = np.array(
            [base.actInv(self._data.oMi[index].translation) - [0.0, 0.0, radius] for index, radius in self._wheels]
        )
        return plane_through(points)


def plane_through(points: FloatArray) -> GroundPlane | None:
    """The plane nearest to points (k, 3) in base_link [m]; None where they lie in a line or are fewer than three."""
    if len(points) < 3:
        return None
    middle = points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(points - middle)
    normal = axes[2] * (1.0 if axes[2, 2] >= 0.0 else -1.0)
    if sizes[1] < _IN_LINE * sizes[0] or normal[2] < 0.5:
        return None
    return GroundPlane(float(normal @ middle), (float(normal[0]), float(normal[1]), float(normal[2])))
