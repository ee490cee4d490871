"""Where a link of the machine truly was: forward kinematics from the recorded truth, by Pinocchio."""

import numpy as np
import pinocchio
from numpy.typing import NDArray

from sojourn_bags.errors import IncompleteConfigError
from sojourn_bags.reading import Bag

FloatArray = NDArray[np.float64]
POSE = tuple(f"pose.pose.{part}" for part in (
    "position.x", "position.y", "position.z",
    "orientation.x", "orientation.y", "orientation.z", "orientation.w",
))  # fmt: skip
"""Of an Odometry."""


def poses_of(bag: Bag, topic: str) -> FloatArray:
    """Poses of an Odometry topic: shape (n, 7), x y z [m] and quaternion x y z w."""
    return bag[topic].columns(*POSE)


def rotate(quaternion: FloatArray, vector: FloatArray) -> FloatArray:
    """Vectors turned by unit quaternions x y z w: v + 2 q x (q x v + w v). Shapes (..., 4), (..., 3)."""
    axis, w = quaternion[..., :3], quaternion[..., 3:]
    return vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)


def euler_angles(quaternions: FloatArray) -> FloatArray:
    """Roll, pitch and yaw of quaternions x y z w, R = Rz(yaw) Ry(pitch) Rx(roll): shape (n, 3) [rad], yaw unwrapped."""
    x, y, z, w = quaternions.T
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([roll, pitch, np.unwrap(yaw)], axis=1)


def tilts(quaternions: FloatArray) -> FloatArray:
    """Angle of the machine's z axis from the vertical, for quaternions of shape (n, 4): shape (n,) [rad]."""
    up = rotate(quaternions, np.array([0.0, 0.0, 1.0]))[..., 2]
    return np.arccos(np.clip(up, -1.0, 1.0))


class TrueMachine:
    """The machine as the truth topics of a bag tell it.

    Args:
        bag: with /truth/odom and /truth/joint_states. urdf: text of the machine's URDF.
    """

    def __init__(self, bag: Bag, urdf: str) -> None:
        self._model = pinocchio.buildModelFromXML(urdf, pinocchio.JointModelFreeFlyer())
        self._data = self._model.createData()
        self._pose_times = bag["/truth/odom"].times
        self._poses = poses_of(bag, "/truth/odom")
        states = bag["/truth/joint_states"]
        self._joint_times, self._joints = states.times, states.joints()

    def pose_at(self, time_s: float) -> FloatArray:
        """Pose of base_link in map at the last period up to a time [s]: x y z and quaternion x y z w."""
        return self._poses[_rows_at(self._pose_times, np.array([time_s]))[0]]

    def point_in_map(self, frame: str, point: FloatArray, time_s: float) -> FloatArray:
        """A point given in map, odom or base_link, in map: shape (3,) [m].

        odom is taken for map: an operator who names a place in odom means the place, not what the odometry
        makes of it.
        Raises ValueError for another frame.
        """
        if frame.lstrip("/") in ("map", "odom"):
            return np.asarray(point, dtype=np.float64)
        if frame.lstrip("/") != "base_link":
            raise ValueError(f"frame {frame!r}: allowed is map, odom or base_link")
        pose = self.pose_at(time_s)
        return pose[:3] + rotate(pose[3:], np.asarray(point, dtype=np.float64))

    def link_in_map(self, link: str, time_s: float) -> FloatArray:
        """Origin of a link's frame in map at the last period up to a time [s]: shape (3,) [m].

        Raises IncompleteConfigError if the URDF has no such link.
        """
        model, data = self._model, self._data
        if not model.existFrame(link):
            raise IncompleteConfigError(f"the machine has no link {link!r}")
        pinocchio.framesForwardKinematics(model, data, self._configurations(np.array([time_s]))[0])
        return np.array(data.oMf[model.getFrameId(link)].translation)

    def centres_of_mass(self, times: FloatArray) -> FloatArray:
        """Centre of mass of the whole machine in map at the last period up to each time [s]: shape (n, 3) [m]."""
        model, data = self._model, self._data
        found = np.empty((len(times), 3))
        for row, configuration in enumerate(self._configurations(times)):
            found[row] = pinocchio.centerOfMass(model, data, configuration)
        return found

    def _configurations(self, times: FloatArray) -> FloatArray:
        """Configuration of the model at the last period up to each time [s]: shape (n, nq)."""
        model = self._model
        found = np.tile(pinocchio.neutral(model), (len(times), 1))
        found[:, :7] = self._poses[_rows_at(self._pose_times, times)]
        rows = _rows_at(self._joint_times, times)
        for column, name in enumerate(self._joints.names):
            if not model.existJointName(name):
                continue
            joint, angles = model.joints[model.getJointId(name)], self._joints.position[rows, column]
            known = np.isfinite(angles)
            if joint.nq == 1:
                found[known, joint.idx_q] = angles[known]
            else:  # a continuous joint is kept as cosine and sine
                found[known, joint.idx_q] = np.cos(angles[known])
                found[known, joint.idx_q + 1] = np.sin(angles[known])
        return found


def joints_to(urdf: str, link: str) -> tuple[str, ...]:
    """Joints between base_link and a link. Raises IncompleteConfigError if the URDF has no such link."""
    model = pinocchio.buildModelFromXML(urdf)
    if not model.existFrame(link):
        raise IncompleteConfigError(f"the machine has no link {link!r}")
    joint = model.frames[model.getFrameId(link)].parentJoint
    return tuple(model.names[number] for number in model.supports[joint] if number)


def _rows_at(times: FloatArray, wanted: FloatArray) -> NDArray[np.int64]:
    """Last row up to each time; half a nanosecond of rounding is forgiven."""
    return np.maximum(0, np.searchsorted(times, wanted + 5e-10, side="right") - 1)
