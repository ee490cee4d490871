"""Values of the contract as messages of the ROS library, field by field, and back over its own serialisation: what a
foreign node says and hears, and the independent route of the codecs' tests.
"""

import array
from typing import Any

from builtin_interfaces.msg import Duration, Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import (
    Point,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TwistStamped,
    Vector3,
    Vector3Stamped,
    WrenchStamped,
)
from nav_msgs.msg import MapMetaData, OccupancyGrid, Odometry, Path
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import (
    BatteryState,
    CameraInfo,
    Image,
    Imu,
    JointState,
    PointCloud2,
    PointField,
    RegionOfInterest,
)
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sojourn_contract import values
from sojourn_contract.codecs import CODECS


def ros_message(value: values.Message) -> Any:
    """The message that a value stands for."""
    return _MAKERS[type(value)](value)


def is_ros(message: Any) -> bool:
    """Whether it is a message of the ROS library."""
    return hasattr(message, "get_fields_and_field_types")


def as_ros(message: Any) -> Any:
    """A value as a message of the ROS library; such a message, or bytes, as they are."""
    return message if is_ros(message) or isinstance(message, bytes) else ros_message(message)


def serialized(message: Any) -> bytes:
    """CDR of a value, or of a message of the ROS library, by that library."""
    return bytes(serialize_message(as_ros(message)))


def value_of(message: Any) -> values.Message:
    """The value that a message of the ROS library stands for, by its bytes."""
    kind = f"{type(message).__module__.partition('.')[0]}/{type(message).__name__}"
    return CODECS[kind].decode(serialized(message))


def ros_time(stamp: int) -> Time:
    """A stamp [ns]."""
    return Time(sec=stamp // 10**9, nanosec=stamp % 10**9)


def _header(value: values.Message) -> Header:
    return Header(stamp=ros_time(value.stamp), frame_id=value.frame)


def _vector(numbers: Any) -> Vector3:
    return Vector3(**dict(zip("xyz", map(float, numbers), strict=True)))


def _pose(position: Any, orientation: Any) -> Pose:
    return Pose(
        position=Point(**dict(zip("xyz", map(float, position), strict=True))),
        orientation=Quaternion(**dict(zip("xyzw", map(float, orientation), strict=True))),
    )


def _doubles(numbers: Any) -> Any:
    return array.array("d", list(numbers))


def _joint_state(value: values.JointState) -> JointState:
    return JointState(
        header=_header(value),
        name=list(value.names),
        position=_doubles(value.position),
        velocity=_doubles(value.velocity),
        effort=_doubles(value.effort),
    )


def _trajectory(value: values.JointTrajectory) -> JointTrajectory:
    points = [
        JointTrajectoryPoint(
            positions=_doubles(point.positions),
            velocities=_doubles(point.velocities),
            accelerations=_doubles(point.accelerations),
            effort=_doubles(point.effort),
            time_from_start=Duration(sec=point.time_from_start // 10**9, nanosec=point.time_from_start % 10**9),
        )
        for point in value.points
    ]
    return JointTrajectory(header=_header(value), joint_names=list(value.names), points=points)


def _odometry(value: values.Odometry) -> Odometry:
    message = Odometry(header=_header(value), child_frame_id=value.child_frame)
    message.pose.pose = _pose(value.position, value.orientation)
    message.pose.covariance = value.pose_covariance
    message.twist.twist.linear, message.twist.twist.angular = _vector(value.linear), _vector(value.angular)
    message.twist.covariance = value.twist_covariance
    return message


def _grid(value: values.OccupancyGrid) -> OccupancyGrid:
    info = MapMetaData(
        map_load_time=ros_time(value.map_load_time),
        resolution=value.resolution,
        width=value.width,
        height=value.height,
        origin=_pose(value.position, value.orientation),
    )
    return OccupancyGrid(header=_header(value), info=info, data=array.array("b", value.data))


def _imu(value: values.Imu) -> Imu:
    return Imu(
        header=_header(value),
        orientation=_pose((0, 0, 0), value.orientation).orientation,
        angular_velocity=_vector(value.angular_velocity),
        linear_acceleration=_vector(value.linear_acceleration),
        orientation_covariance=value.orientation_covariance,
        angular_velocity_covariance=value.angular_velocity_covariance,
        linear_acceleration_covariance=value.linear_acceleration_covariance,
    )


def _wrench(value: values.WrenchStamped) -> WrenchStamped:
    message = WrenchStamped(header=_header(value))
    message.wrench.force, message.wrench.torque = _vector(value.force), _vector(value.torque)
    return message


def _twist(value: values.TwistStamped) -> TwistStamped:
    message = TwistStamped(header=_header(value))
    message.twist.linear, message.twist.angular = _vector(value.linear), _vector(value.angular)
    return message


def _pose_stamped(value: values.PoseStamped) -> PoseStamped:
    return PoseStamped(header=_header(value), pose=_pose(value.position, value.orientation))


def _place(value: values.PoseWithCovarianceStamped) -> PoseWithCovarianceStamped:
    message = PoseWithCovarianceStamped(header=_header(value))
    message.pose.pose, message.pose.covariance = _pose(value.position, value.orientation), value.covariance
    return message


def _battery(value: values.BatteryState) -> BatteryState:
    fields = value._asdict()
    del fields["stamp"], fields["frame"]
    cells = {name: array.array("f", fields.pop(name)) for name in ("cell_voltage", "cell_temperature")}
    return BatteryState(header=_header(value), **fields, **cells)


def _cloud(value: values.PointCloud2) -> PointCloud2:
    fields = value._asdict()
    del fields["stamp"], fields["frame"]
    fields["fields"] = [
        PointField(name=one.name, offset=one.offset, datatype=one.datatype, count=one.elements) for one in value.fields
    ]
    fields["data"] = array.array("B", value.data)
    return PointCloud2(header=_header(value), **fields)


def _image(value: values.Image) -> Image:
    fields = value._asdict()
    del fields["stamp"], fields["frame"]
    return Image(header=_header(value), **fields | {"data": array.array("B", value.data)})


def _camera_info(value: values.CameraInfo) -> CameraInfo:
    return CameraInfo(
        header=_header(value),
        height=value.height,
        width=value.width,
        distortion_model=value.distortion_model,
        d=_doubles(value.distortion),
        k=value.intrinsic,
        r=value.rectification,
        p=value.projection,
        binning_x=value.binning_x,
        binning_y=value.binning_y,
        roi=RegionOfInterest(**value.roi._asdict()),
    )


def _diagnostics(value: values.DiagnosticArray) -> DiagnosticArray:
    status = [
        DiagnosticStatus(
            level=bytes([one.level]),
            name=one.name,
            message=one.message,
            hardware_id=one.hardware_id,
            values=[KeyValue(key=key, value=text) for key, text in one.values],
        )
        for one in value.status
    ]
    return DiagnosticArray(header=_header(value), status=status)


_MAKERS = {
    values.Clock: lambda value: Clock(clock=ros_time(value.stamp)),
    values.Header: _header,
    values.JointState: _joint_state,
    values.JointTrajectory: _trajectory,
    values.Odometry: _odometry,
    values.OccupancyGrid: _grid,
    values.Imu: _imu,
    values.WrenchStamped: _wrench,
    values.Vector3Stamped: lambda value: Vector3Stamped(header=_header(value), vector=_vector(value.vector)),
    values.TwistStamped: _twist,
    values.PoseStamped: _pose_stamped,
    values.PoseWithCovarianceStamped: _place,
    values.Path: lambda value: Path(header=_header(value), poses=[_pose_stamped(pose) for pose in value.poses]),
    values.BatteryState: _battery,
    values.PointCloud2: _cloud,
    values.DiagnosticArray: _diagnostics,
    values.Image: _image,
    values.CameraInfo: _camera_info,
}
