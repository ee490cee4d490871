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


def bag_information(
    file: str, topics: Sequence[TopicEntry], start: int, end: int, custom: Mapping[str, str]
) -> dict[str, Any]:
    """Content of metadata.yaml of a bag of one file. Topics without a message are left out.

    Args:
        file: name of the MCAP file. start, end: first and last log time [ns]. custom: texts by name.
    """
    total = sum(topic.count for topic in topics)
    starting = {"nanoseconds_since_epoch": start if total else 0}
    duration = {"nanoseconds": end - start if total else 0}
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
            "duration": duration,
            "starting_time": starting,
            "message_count": total,
            "topics_with_message_count": entries,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file],
            "files": [
                {
                    "path": file,
                    "starting_time": dict(starting),
                    "duration": dict(duration),
                    "message_count": total,
                }
            ],
            "custom_data": dict(custom) or None,
            "ros_distro": "jazzy",
        }
    }


def write_metadata_file(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write it beside the final name first, so that there is always a whole file."""
    draft = folder / (METADATA_FILE + ".part")
    draft.write_text(yaml.safe_dump(dict(metadata), sort_keys=False), encoding="utf-8")
    draft.replace(folder / METADATA_FILE)
