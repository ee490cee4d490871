"""A node of the ROS library that opens nothing by itself: what nobody uses is no way in, and needs no permission.

What is left is /parameter_events, on which the library says what the node's parameters are.
"""

from collections.abc import Mapping
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

TYPE_DESCRIPTIONS = "start_type_description_service"
"""Parameter of every node of the ROS library: whether it tells about its types by a service."""


class ClosedNode(Node):
    """Without a log on /rosout, and without any service.

    Args:
        name: of the node. context: rclpy context. namespace: None or "" for that of the command line.
        overrides: values of its parameters, over those of the command line.
    """

    def __init__(
        self,
        name: str,
        *,
        context: Context | None = None,
        namespace: str | None = None,
        overrides: Mapping[str, Any] | None = None,
    ) -> None:
        values = {**(overrides or {}), TYPE_DESCRIPTIONS: False}
        super().__init__(
            name,
            context=context,
            namespace=namespace,
            parameter_overrides=[Parameter(key, value=value) for key, value in values.items()],
            enable_rosout=False,
            start_parameter_services=False,
        )
