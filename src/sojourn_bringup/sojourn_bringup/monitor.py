"""Listens to the heartbeats of a run: the supervisor's only ROS node."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import rclpy
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions

from sojourn_bringup.access import SUPERVISOR
from sojourn_bringup.health import Health, Progress
from sojourn_bringup.plant_time import PlantTime
from sojourn_contract import qos
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.decoding import hearing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import read_heartbeats, status_values
from sojourn_contract.prompt_executor import PromptExecutor
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_contract.values import DiagnosticArray


class Monitor:
    """Keeps the health of the nodes and the progress of the run up to date. A context manager.

    Args:
        namespace: namespace of the run. nodes: health by role, updated in place. time: of the run, likewise.
        arguments: of ROS, for its node.
    """

    def __init__(
        self, namespace: str, nodes: Mapping[str, Health], time: PlantTime, arguments: Sequence[str] = ()
    ) -> None:
        self.nodes = nodes
        self.progress = Progress()
        self._namespace, self._time = namespace, time
        self._arguments = ["--ros-args", *arguments] if arguments else []

    def __enter__(self) -> "Monitor":
        rclpy.init(args=self._arguments, signal_handler_options=SignalHandlerOptions.NO)
        self._node = ClosedNode(SUPERVISOR, namespace=self._namespace)
        self.listen(topic("/diagnostics"), self._on_heartbeat)
        self.listen(topic("/drive/status"), self._on_drive_status)
        self._executor = PromptExecutor()
        self._executor.add_node(self._node)
        return self

    def __exit__(self, *_error: object) -> None:
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown()

    def spin(self, seconds: float) -> None:
        """Take what arrives for so long [s]."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def sender(self, row: Topic, quality: QoSProfile) -> Any:
        """A publisher of a row."""
        return self._node.create_publisher(message_class(row.type), row.name.lstrip("/"), quality)

    def listen(self, row: Topic, callback: Any, quality: QoSProfile | None = None) -> None:
        """Give what comes on a row to a callback. By default it may lag as far as the recorder."""
        hear = hearing(row, callback, self._pass_over)
        kind, profile = message_class(row.type), quality or qos.profile(row, True, "recorder")
        self._node.create_subscription(kind, row.name.lstrip("/"), hear, profile, raw=True)

    def _pass_over(self, refusal: RefusedMessageError) -> None:
        """Of what cannot be read; the nodes refuse and count it."""
        self._node.get_logger().warning(f"refused: {refusal}", throttle_duration_sec=1.0)

    def _on_heartbeat(self, message: DiagnosticArray) -> None:
        now = time.monotonic()
        for beat in read_heartbeats(message):
            node = self.nodes.get(beat.role)
            if node is None:
                continue
            node.hear(beat, now)
            if beat.role == "plant" and beat.stamp:
                self._time.hear(beat.stamp, now)
                self.progress.stamp = self._time.now
            elif beat.role == "operator":
                self.progress.hear_operator(beat.values)

    def _on_drive_status(self, message: DiagnosticArray) -> None:
        self.progress.hear_drive(status_values(message))
