"""What a bag says of a message type and of a topic's quality of service, in the words of rosbag2.

Definitions are `ros2msg`: the text of the .msg file, and after a line of 80 '=' that of every type it uses.
The hash is RIHS01 (REP 2016). Both come from the Jazzy type store of rosbags, so that no sourced ROS 2 is
needed.
"""

import contextlib
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from sojourn_bags.errors import UnreadableMessageError

if TYPE_CHECKING:  # who reads a bag needs none of the ROS library
    from rclpy.qos import QoSProfile

_NANOSECONDS = 1_000_000_000
CONFIGURATION_NAME = "configuration.json"
"""Name of the attachment that says how a run was configured: it stands before all messages."""
RUN_RECORD = "sojourn_run"
"""Name of the metadata record that describes the run."""
THINNED_RECORD = "sojourn_thinned"
"""Name of the metadata record that says to whose topics a bag is thinned."""
RECOVERY_RECORD = "sojourn_recovery"
"""Name of the metadata record that says that a bag has been mended, and from what."""


@dataclass(frozen=True)
class ChannelSpec:
    """One topic of a bag.

    Args:
        topic: name in the bag. type: "package/Name". qos: what `qos_entry` returns.
    """

    topic: str
    type: str
    qos: dict[str, Any]

    @property
    def full_type(self) -> str:
        """Type as bags name it: "package/msg/Name"."""
        return full_type(self.type)


def full_type(name: str) -> str:
    """ "package/msg/Name" of "package/Name"."""
    package, _, short = name.partition("/")
    return f"{package}/msg/{short}"


@cache
def typestore() -> Typestore:
    """All message types of ROS 2 Jazzy, tf2_msgs among them."""
    return get_typestore(Stores.ROS2_JAZZY)


def deserialized(type_name: str, data: bytes) -> Any:
    """The message of type "package/msg/Name" in some bytes. Raises UnreadableMessageError where they hold none."""
    try:
        return typestore().deserialize_cdr(data, type_name)
    except Exception as error:  # the type store names its own errors, and lets those of the bytes through
        raise UnreadableMessageError(type_name, len(data), f"{type(error).__name__}: {error}") from error


def learn(type_name: str, text: str) -> None:
    """Learn a message type that a bag brings along, and those that it uses, from its `ros2msg` definition.

    Types that are known stay as they are; a text that cannot be read leaves the type unknown.
    """
    store = typestore()
    if type_name in store.fielddefs:
        return
    with contextlib.suppress(TypesysError, ValueError, KeyError, RecursionError):
        found = get_types_from_msg(text, type_name)
        store.register({name: fields for name, fields in found.items() if name not in store.fielddefs})


@cache
def definition(type_name: str) -> str:
    """Definition of "package/msg/Name" with all types it uses."""
    text, _ = typestore().generate_msgdef(type_name, ros_version=2)
    return text


@cache
def type_hash(type_name: str) -> str:
    """RIHS01 hash of "package/msg/Name"."""
    return typestore().hash_rihs01(type_name)


def offered_entries(nominal: dict[str, Any], offered: Iterable["QoSProfile"]) -> list[dict[str, Any]]:
    """What publishers offer, each profile once. Others are not told history and depth: as in `nominal`."""
    found: list[dict[str, Any]] = []
    for profile in offered:
        told = {"reliability": profile.reliability.name.lower(), "durability": profile.durability.name.lower()}
        entry = deepcopy(nominal) | told
        if entry not in found:
            found.append(entry)
    return found


def qos_entry(profile: "QoSProfile") -> dict[str, Any]:
    """A profile as metadata of version 9 writes it."""
    from rclpy.duration import Infinite

    endless = {"sec": Infinite.nanoseconds // _NANOSECONDS, "nsec": Infinite.nanoseconds % _NANOSECONDS}
    return {
        "history": profile.history.name.lower(),
        "depth": profile.depth,
        "reliability": profile.reliability.name.lower(),
        "durability": "volatile",
        "deadline": dict(endless),
        "lifespan": dict(endless),
        "liveliness": "automatic",
        "liveliness_lease_duration": dict(endless),
        "avoid_ros_namespace_conventions": False,
    }
