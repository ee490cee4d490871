"""Values of messages to the bytes that go over the wire, and back: `encode`, `decode`, by the type of ROS.

What an app says is made bytes once, here, and what it hears is read once; a node publishes and takes bytes, and others
see ordinary messages of ROS. Making ROS messages of the same in Python takes several times as long.
"""

from collections.abc import Mapping

from sojourn_contract import values
from sojourn_contract.codecs import blocks
from sojourn_contract.codecs.battery import BatteryStateCodec
from sojourn_contract.codecs.blocks import BlockCodec
from sojourn_contract.codecs.clouds import PointCloudCodec
from sojourn_contract.codecs.codec import Codec
from sojourn_contract.codecs.grids import OccupancyGridCodec
from sojourn_contract.codecs.images import CameraInfoCodec, ImageCodec
from sojourn_contract.codecs.joints import JointStateCodec, JointTrajectoryCodec
from sojourn_contract.codecs.paths import PathCodec
from sojourn_contract.codecs.ros_library import codec_of
from sojourn_contract.codecs.texts import ClockCodec, DiagnosticsCodec, HeaderCodec
from sojourn_contract.errors import unreadable
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message

CODECS: Mapping[str, Codec] = {
    "diagnostic_msgs/DiagnosticArray": DiagnosticsCodec(),
    "geometry_msgs/PoseStamped": BlockCodec(values.PoseStamped, blocks.POSE),
    "geometry_msgs/PoseWithCovarianceStamped": BlockCodec(
        values.PoseWithCovarianceStamped, blocks.POSE_WITH_COVARIANCE
    ),
    "geometry_msgs/TwistStamped": BlockCodec(values.TwistStamped, blocks.TWIST),
    "geometry_msgs/Vector3Stamped": BlockCodec(values.Vector3Stamped, blocks.VECTOR),
    "geometry_msgs/WrenchStamped": BlockCodec(values.WrenchStamped, blocks.WRENCH),
    "nav_msgs/OccupancyGrid": OccupancyGridCodec(),
    "nav_msgs/Odometry": BlockCodec(values.Odometry, blocks.ODOMETRY, texts=2),
    "nav_msgs/Path": PathCodec(),
    "rosgraph_msgs/Clock": ClockCodec(),
    "sensor_msgs/BatteryState": BatteryStateCodec(),
    "sensor_msgs/CameraInfo": CameraInfoCodec(),
    "sensor_msgs/Image": ImageCodec(),
    "sensor_msgs/Imu": BlockCodec(values.Imu, blocks.IMU),
    "sensor_msgs/JointState": JointStateCodec(),
    "sensor_msgs/PointCloud2": PointCloudCodec(),
    "std_msgs/Header": HeaderCodec(),
    "trajectory_msgs/JointTrajectory": JointTrajectoryCodec(),
}
"""Of every type in the topic table and those of cameras; a sensor from elsewhere may say others, which the ROS library
makes bytes of.
"""


def encode(row: Topic, value: Message) -> bytes:
    """CDR of a value of a row's type. Raises ValueError, TypeError or struct.error for what the type cannot hold."""
    return _codec(row.type).encode(value)


def decode(row: Topic, data: bytes) -> Message:
    """The value in these bytes. Raises RefusedMessageError where they hold none of the row's type."""
    try:
        return _codec(row.type).decode(data)
    except Exception as error:  # whatever hostile bytes bring about
        raise unreadable(row.name, f"a serialised {row.type}", error, data) from error


def _codec(kind: str) -> Codec:
    return CODECS.get(kind) or codec_of(kind)
