"""rosbag2's metadata.yaml, the file beside a bag by which ROS tools open it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

BAG_VERSION = 9
"""Version of rosbag2's metadata, that of Jazzy."""
METADATA_FILE = "metadata.yaml"


@dataclass(frozen=True)
class TopicEntry:
    """One topic: its name, "package/msg/Name", offered quality of service, hash of the type, messages in the bag."""

    name: str
    type: str
    qos: list[dict[str, Any]]
    type_hash: str
    count: int


@dataclass
class PartEntry:
    """One file of a bag: its name, the messages in it, first and last log time [ns]."""

    file: str
    count: int = 0
    first: int = 0
    last: int = 0

    def take(self, log_time: int) -> None:
        """One more message."""
        if not self.count or log_time < self.first:
            self.first = log_time
        if log_time > self.last:
            self.last = log_time
        self.count += 1

    @property
    def times(self) -> dict[str, dict[str, int]]:
        """As metadata.yaml has them."""
        return {
            "starting_time": {"nanoseconds_since_epoch": self.first},
            "duration": {"nanoseconds": self.last - self.first},
        }


def bag_information(
    parts: Sequence[PartEntry], topics: Sequence[TopicEntry], custom: Mapping[str, str]
) -> dict[str, Any]:
    """Content of metadata.yaml. Topics without a message are left out.

    Args:
        parts: files of the bag, in their order. custom: texts by name.
    """
    total = sum(topic.count for topic in topics)
    filled = [part for part in parts if part.count]
    whole = PartEntry("", total, min((part.first for part in filled), default=0), max(part.last for part in parts))
    entries = [
        {
            "topic_metadata": {
                "name": topic.name,
                "type": topic.type,
                "serialization_format": "cdr",
                "offered_qos_profiles": topic.qos,
                "type_description_hash": topic.type_hash,
            },
            "message_count": topic.count,
        }
        for topic in topics
        if topic.count
    ]
    return {
        "rosbag2_bagfile_information": {
            "version": BAG_VERSION,
            "storage_identifier": "mcap",
            "duration": whole.times["duration"],
            "starting_time": whole.times["starting_time"],
            "message_count": total,
            "topics_with_message_count": entries,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [part.file for part in parts],
            "files": [{"path": part.file, **part.times, "message_count": part.count} for part in parts],
            "custom_data": dict(custom) or None,
            "ros_distro": "jazzy",
        }
    }


def write_metadata_file(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write it beside the final name first, so that there is always a whole file."""
    draft = folder / (METADATA_FILE + ".part")
    draft.write_text(yaml.safe_dump(dict(metadata), sort_keys=False), encoding="utf-8")
    draft.replace(folder / METADATA_FILE)
