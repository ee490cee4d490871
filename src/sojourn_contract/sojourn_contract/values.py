"""What messages say, as values: one class for each type of the topic table, with the names of ROS.

A value is never changed: who gets one may keep it, and need not copy it. Its stamp is simulation time in integer
nanoseconds, its frame that of its header. Arrays are float64, shape given with each; nobody writes to them. They are
made of bytes and bytes of them by `codecs`.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from sojourn_machine.params import FloatArray

NOTHING: FloatArray = np.zeros(0)
NO_COVARIANCE: FloatArray = np.zeros(36)
NO_COVARIANCE_3: FloatArray = np.zeros(9)
UPRIGHT: FloatArray = np.array([0.0, 0.0, 0.0, 1.0])
NOT_MEASURED = math.nan
for _constant in (NOTHING, NO_COVARIANCE, NO_COVARIANCE_3, UPRIGHT):
    _constant.flags.writeable = False


class Clock(NamedTuple):
    """rosgraph_msgs/Clock."""

    stamp: int


class Header(NamedTuple):
    """std_msgs/Header."""

    stamp: int
    frame: str = ""


class JointState(NamedTuple):
    """sensor_msgs/JointState: angles [rad] or ways [m], rates [rad/s] or [m/s], efforts [N m] or [N], each
    (len(names),) or empty.
    """

    stamp: int
    names: tuple[str, ...]
    position: FloatArray = NOTHING
    velocity: FloatArray = NOTHING
    effort: FloatArray = NOTHING
    frame: str = ""


class TrajectoryPoint(NamedTuple):
    """trajectory_msgs/JointTrajectoryPoint: each array (joints,) or empty."""

    positions: FloatArray
    velocities: FloatArray = NOTHING
    accelerations: FloatArray = NOTHING
    effort: FloatArray = NOTHING
    time_from_start: int = 0
    """[ns]"""


class JointTrajectory(NamedTuple):
    """trajectory_msgs/JointTrajectory."""

    stamp: int
    names: tuple[str, ...]
    points: tuple[TrajectoryPoint, ...]
    frame: str = ""


class Odometry(NamedTuple):
    """nav_msgs/Odometry: position (3,) [m] and orientation (4,) x y z w of the child frame, its velocity (3,) [m/s] and
    angular velocity (3,) [rad/s] in itself; covariances (36,), row by row.
    """

    stamp: int
    frame: str
    child_frame: str
    position: FloatArray
    orientation: FloatArray
    linear: FloatArray
    angular: FloatArray
    pose_covariance: FloatArray = NO_COVARIANCE
    twist_covariance: FloatArray = NO_COVARIANCE


class Imu(NamedTuple):
    """sensor_msgs/Imu: orientation (4,) x y z w, angular velocity (3,) [rad/s], specific force (3,) [m/s^2];
    covariances (9,), row by row.
    """

    stamp: int
    frame: str
    orientation: FloatArray
    angular_velocity: FloatArray
    linear_acceleration: FloatArray
    orientation_covariance: FloatArray = NO_COVARIANCE_3
    angular_velocity_covariance: FloatArray = NO_COVARIANCE_3
    linear_acceleration_covariance: FloatArray = NO_COVARIANCE_3


class WrenchStamped(NamedTuple):
    """geometry_msgs/WrenchStamped: force (3,) [N] and torque (3,) [N m]; NaN throughout where not measured."""

    stamp: int
    frame: str
    force: FloatArray
    torque: FloatArray


class Vector3Stamped(NamedTuple):
    """geometry_msgs/Vector3Stamped: (3,)."""

    stamp: int
    frame: str
    vector: FloatArray


class TwistStamped(NamedTuple):
    """geometry_msgs/TwistStamped: (3,) [m/s] and (3,) [rad/s]."""

    stamp: int
    frame: str
    linear: FloatArray
    angular: FloatArray


class PoseStamped(NamedTuple):
    """geometry_msgs/PoseStamped: position (3,) [m], orientation (4,) x y z w."""

    stamp: int
    frame: str
    position: FloatArray
    orientation: FloatArray = UPRIGHT


class PoseWithCovarianceStamped(NamedTuple):
    """geometry_msgs/PoseWithCovarianceStamped: position (3,) [m], orientation (4,) x y z w, covariance (36,) of x, y, z
    and the rotations about x, y, z.
    """

    stamp: int
    frame: str
    position: FloatArray
    orientation: FloatArray
    covariance: FloatArray


class Path(NamedTuple):
    """nav_msgs/Path."""

    stamp: int
    frame: str
    poses: tuple[PoseStamped, ...]


class BatteryState(NamedTuple):
    """sensor_msgs/BatteryState, its numbers as its fields of 32 bits hold them: [V], [degree Celsius], [A], negative
    out of the store, [Ah], 0 to 1.
    """

    stamp: int
    frame: str = ""
    voltage: float = NOT_MEASURED
    temperature: float = NOT_MEASURED
    current: float = NOT_MEASURED
    charge: float = NOT_MEASURED
    capacity: float = NOT_MEASURED
    design_capacity: float = NOT_MEASURED
    percentage: float = NOT_MEASURED
    power_supply_status: int = 0
    power_supply_health: int = 0
    power_supply_technology: int = 0
    present: bool = True
    cell_voltage: tuple[float, ...] = ()
    cell_temperature: tuple[float, ...] = ()
    location: str = ""
    serial_number: str = ""


class PointField(NamedTuple):
    """sensor_msgs/PointField."""

    name: str
    offset: int
    datatype: int
    elements: int = 1
    """Its `count` in ROS."""


FLOAT32, FLOAT64 = 7, 8
"""Datatypes of a PointField."""


class PointCloud2(NamedTuple):
    """sensor_msgs/PointCloud2."""

    stamp: int
    frame: str
    width: int
    fields: tuple[PointField, ...]
    point_step: int
    data: bytes
    height: int = 1
    row_step: int = 0
    is_bigendian: bool = False
    is_dense: bool = True


class Image(NamedTuple):
    """sensor_msgs/Image."""

    stamp: int
    frame: str
    height: int
    width: int
    encoding: str
    """As "mono8", "16UC1"."""
    step: int
    """Bytes of a row."""
    data: bytes
    is_bigendian: int = 0


class RegionOfInterest(NamedTuple):
    """sensor_msgs/RegionOfInterest."""

    x_offset: int = 0
    y_offset: int = 0
    height: int = 0
    width: int = 0
    do_rectify: bool = False


class CameraInfo(NamedTuple):
    """sensor_msgs/CameraInfo."""

    stamp: int
    frame: str
    height: int
    width: int
    distortion_model: str
    distortion: FloatArray
    """Its `d`."""
    intrinsic: FloatArray
    """Its `k`, (9,)."""
    rectification: FloatArray
    """Its `r`, (9,)."""
    projection: FloatArray
    """Its `p`, (12,)."""
    binning_x: int = 0
    binning_y: int = 0
    roi: RegionOfInterest = RegionOfInterest()


class OccupancyGrid(NamedTuple):
    """nav_msgs/OccupancyGrid: cells in rows along y, each along x, of -1 (not known), 0 (free) to 100 (closed)."""

    stamp: int
    frame: str
    resolution: float
    """Side of a cell, as its field of 32 bits holds it [m]."""
    width: int
    height: int
    """Cells along x and y."""
    position: FloatArray
    """Corner of the first cell, (3,) [m]."""
    data: bytes
    """A signed byte a cell."""
    orientation: FloatArray = UPRIGHT
    """Of the grid, (4,) x y z w."""
    map_load_time: int = 0
    """[ns]"""


class DiagnosticStatus(NamedTuple):
    """diagnostic_msgs/DiagnosticStatus; level: 0 good, 1 warning, 2 error, 3 stale."""

    name: str
    values: tuple[tuple[str, str], ...] = ()
    message: str = ""
    level: int = 0
    hardware_id: str = ""


class DiagnosticArray(NamedTuple):
    """diagnostic_msgs/DiagnosticArray."""

    stamp: int
    status: tuple[DiagnosticStatus, ...]
    frame: str = ""


class Serialised(NamedTuple):
    """A message of a type that has no class here, as its bytes: see `codecs.ros_library`."""

    stamp: int
    type: str
    """ "package/Name"."""
    cdr: bytes


Message: TypeAlias = Any
"""One of the values above. Every one has a stamp."""
