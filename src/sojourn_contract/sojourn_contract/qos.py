"""Quality of service of each topic, from its row and the mode of time."""

from typing import TYPE_CHECKING

from sojourn_contract.topic_types import Reliability, Topic
from sojourn_contract.topics import RECORDER_LAG

if TYPE_CHECKING:  # who says what the contract is needs none of the ROS library
    from rclpy.qos import QoSProfile

DEPTH = 10
RECORDER_DEPTH = 8 * RECORDER_LAG
"""The recorder may lag by RECORDER_LAG periods, and loses nothing while it does."""


def is_best_effort(row: Topic, lockstep: bool) -> bool:
    """Whether a message of the row may be lost: clouds, images, and /clock outside lock-step."""
    return row.reliability is Reliability.BEST_EFFORT or (row.name == "/clock" and not lockstep)


def depth(row: Topic, lockstep: bool) -> int:
    """Messages of the row that are kept, by all but the recorder."""
    return 1 if row.name == "/clock" and not lockstep else DEPTH


def profile(row: Topic, lockstep: bool, role: str = "") -> "QoSProfile":
    """Profile for publishing or subscribing `row`.

    Reliable and keep last 10, but for clouds and images (best effort) and for /clock outside lock-step
    (best effort, depth 1). The recorder keeps a longer history, which is its own affair and compatible with
    every publisher.
    """
    from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy

    best_effort = is_best_effort(row, lockstep)
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=RECORDER_DEPTH if role == "recorder" else depth(row, lockstep),
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
    )


def looking() -> "QoSProfile":
    """Profile of one who needs no more of a row than a picture shows: best effort, the newest alone."""
    from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
