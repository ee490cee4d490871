"""Quality of service of each topic, from its row and the mode of time."""

from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy

from sojourn_contract.topic_types import Reliability, Topic
from sojourn_contract.topics import RECORDER_LAG

DEPTH = 10
RECORDER_DEPTH = 8 * RECORDER_LAG
"""The recorder may lag by RECORDER_LAG periods, and loses nothing while it does."""


def profile(row: Topic, lockstep: bool, role: str = "") -> QoSProfile:
    """Profile for publishing or subscribing `row`.

    Reliable and keep last 10, but for clouds and images (best effort) and for /clock outside lock-step
    (best effort, depth 1). The recorder keeps a longer history, which is its own affair and compatible with
    every publisher.
    """
    best_effort = row.reliability is Reliability.BEST_EFFORT or (row.name == "/clock" and not lockstep)
    depth = 1 if row.name == "/clock" and not lockstep else DEPTH
    if role == "recorder":
        depth = RECORDER_DEPTH
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
    )
