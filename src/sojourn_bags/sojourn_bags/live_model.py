"""The machine as viewers look for it while it runs: /robot_description, /tf_static and /tf.

RViz, Foxglove and viser draw it with them. They belong to no run: nobody waits for them, no bag has them but for the
/tf of the recorder, and while nobody listens nothing is made. Poses are those of the bag's /tf (see `transforms`), the
links stand as the joints truly do. In lock-step they come up to some periods late, as the recorder does.
"""

import struct
from collections.abc import Collection
from itertools import chain
from typing import TYPE_CHECKING, Any

from sojourn_bags.errors import TransformTypeError
from sojourn_bags.link_frames import LinkFrames
from sojourn_bags.recording import ODOMETRY, TRUTH
from sojourn_bags.transform_message import transform_message_class
from sojourn_bags.transforms import TransformSource
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class

if TYPE_CHECKING:
    from rclpy.node import Node

JOINTS = "/truth/joint_states"
EVERY = 2
"""Control periods from one /tf to the next."""
MOST = 10
"""Stamps of which something is kept until all is there."""


class LiveModel:
    """Of the machine of a run, said by a node.

    Args:
        heard: topics of the run, of those from which it is made.
    """

    def __init__(self, node: "Node", scenario: LoadedScenario, heard: Collection[str]) -> None:
        urdf, sensors = scenario.urdf, scenario.sensors.named.values()
        self._wanted = frozenset(heard) & {TRUTH, ODOMETRY, JOINTS}
        self._heard: dict[int, dict[str, bytes]] = {}
        self._links = LinkFrames(urdf, chain.from_iterable(one.optical_frames for one in sensors))
        self._poses = TransformSource()
        self._latched = [_said_once(node, "robot_description", message_class("std_msgs/String"), urdf.text)]
        self._frames: Any = None
        try:
            kind = transform_message_class()
        except TransformTypeError as error:
            node.get_logger().warning(f"no /tf and /tf_static: {error}")
            return
        self._latched.append(_said_once(node, "tf_static", kind, self._links.fixed()))
        self._frames = node.create_publisher(kind, "tf", 100)

    def hear(self, name: str, stamp: int, message: bytes) -> None:
        """Say the frames of a stamp [ns] when all that they are made of is there, if anybody listens."""
        if name not in self._wanted or stamp % (EVERY * CONTROL_PERIOD_NS) or self._frames is None:
            return
        if not self._frames.get_subscription_count():
            self._heard.clear()
            return
        heard = self._heard.setdefault(stamp, {})
        heard[name] = message
        if len(heard) == len(self._wanted):
            del self._heard[stamp]
            self._say(stamp, heard)
        while len(self._heard) > MOST:  # something is missing there, or refused
            del self._heard[min(self._heard)]

    def _say(self, stamp: int, heard: dict[str, bytes]) -> None:
        try:
            poses = self._poses.message(stamp, heard.get(TRUTH), heard.get(ODOMETRY))
            told = decode(topic(JOINTS), heard[JOINTS]) if JOINTS in heard else None
        except (RefusedMessageError, struct.error):
            return  # the recorder says so
        if poses is not None:
            self._frames.publish(poses)
        positions = {} if told is None else dict(zip(told.names, told.position.tolist(), strict=False))
        self._frames.publish(self._links.moving(stamp, positions))


def _said_once(node: "Node", name: str, kind: Any, said: Any) -> Any:
    """A publisher that has said one thing, which also those hear who come later."""
    from rclpy.qos import DurabilityPolicy, QoSProfile

    publisher = node.create_publisher(kind, name, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    publisher.publish(kind(data=said) if isinstance(said, str) else said)
    return publisher
