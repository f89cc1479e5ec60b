"""`metadata.yaml`: what a bag holds, version 9 of rosbag2's layout.

It is always written whole and atomically, first when a bag is begun, so that a bag
whose recorder was killed has one, too; its counts are then those of the last update.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import msgspec

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagTopic, known_profiles
from biped_common.atomic_file import atomic_file
from biped_common.plain_yaml import YamlError, read_yaml_file, yaml_text

FILE_NAME = "metadata.yaml"
OWN_RECORD = "rosbag2"
"""MCAP metadata record in which each file repeats it, as of the file's end."""
_VERSION = 9
_ROOT = "rosbag2_bagfile_information"


@dataclass
class FileInfo:
    """One MCAP file of a bag."""

    path: str
    """Relative to the bag's folder."""
    start_ns: int = 0
    """log_time of the first message, 0 if there is none."""
    end_ns: int = 0
    """log_time of the last message."""
    message_count: int = 0


@dataclass
class BagMetadata:
    """Everything that `metadata.yaml` says."""

    topics: list[BagTopic] = field(default_factory=list)
    """As read, without definitions."""
    files: list[FileInfo] = field(default_factory=list)
    custom: Mapping[str, str] = field(default_factory=dict)
    """Remarks of whoever wrote the bag."""
    ros_distro: str = "jazzy"

    @property
    def message_count(self) -> int:
        """Messages of all files."""
        return sum(file.message_count for file in self.files)

    @property
    def start_ns(self) -> int:
        """log_time of the first message, 0 if there is none."""
        return min((f.start_ns for f in self.files if f.message_count), default=0)

    @property
    def end_ns(self) -> int:
        """log_time of the last message, 0 if there is none."""
        return max((f.end_ns for f in self.files if f.message_count), default=0)


def metadata_text(metadata: BagMetadata, *, with_root: bool = True) -> str:
    """Return the YAML of a bag.

    Args:
        metadata: of the bag.
        with_root: with the one key above everything that files have.
    """
    content = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "duration": {"nanoseconds": metadata.end_ns - metadata.start_ns},
        "starting_time": {"nanoseconds_since_epoch": metadata.start_ns},
        "message_count": metadata.message_count,
        "topics_with_message_count": [_topic_content(t) for t in metadata.topics],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.path for file in metadata.files],
        "files": [
            {
                "path": file.path,
                "starting_time": {"nanoseconds_since_epoch": file.start_ns},
                "duration": {"nanoseconds": file.end_ns - file.start_ns},
                "message_count": file.message_count,
            }
            for file in metadata.files
        ],
        "custom_data": dict(metadata.custom) or None,
        "ros_distro": metadata.ros_distro,
    }
    # rosbag2 knows no aliases.
    return yaml_text({_ROOT: content} if with_root else content)


def write_metadata(folder: Path, metadata: BagMetadata) -> None:
    """Put the metadata of a bag in place, whole or not at all."""
    with atomic_file(folder / FILE_NAME) as stream:
        stream.write(metadata_text(metadata).encode())


def read_metadata(folder: Path) -> BagMetadata:
    """Return the metadata of a bag.

    Raises:
        BagError: there is none, or it cannot be understood.
    """
    path = folder / FILE_NAME
    try:
        root = msgspec.convert(read_yaml_file(path), dict[str, Any])
        content = msgspec.convert(root.get(_ROOT), _Content)
    except OSError as error:
        raise BagError(f"{path}: cannot be read ({error.strerror})") from None
    except (YamlError, msgspec.ValidationError) as error:
        raise BagError(f"{path}: is no metadata of a bag ({error})") from None
    return BagMetadata(
        topics=[_topic_of(topic) for topic in content.topics_with_message_count],
        files=[
            FileInfo(
                path=file.path,
                start_ns=file.starting_time.nanoseconds_since_epoch,
                end_ns=file.starting_time.nanoseconds_since_epoch
                + file.duration.nanoseconds,
                message_count=file.message_count,
            )
            for file in content.files
        ],
        custom={key: str(value) for key, value in (content.custom_data or {}).items()},
        ros_distro=content.ros_distro or "",
    )


def _topic_content(topic: BagTopic) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": topic.name,
            "type": topic.type_name,
            "serialization_format": topic.encoding,
            "offered_qos_profiles": [dict(qos) for qos in topic.offered_qos],
            "type_description_hash": topic.type_hash,
        },
        "message_count": topic.count,
    }


def _topic_of(content: _Topic) -> BagTopic:
    about = content.topic_metadata
    return BagTopic(
        name=about.name,
        type_name=about.type,
        offered_qos=known_profiles(about.offered_qos_profiles),
        type_hash=about.type_description_hash,
        count=content.message_count,
    )


# -- what is read of metadata.yaml -----------------------------------------------------

_Count = Annotated[int, msgspec.Meta(ge=0, le=2**63 - 1)]
_Nanoseconds = Annotated[int, msgspec.Meta(ge=-(2**63), le=2**63 - 1)]


class _Moment(msgspec.Struct):
    nanoseconds_since_epoch: _Nanoseconds


class _Duration(msgspec.Struct):
    nanoseconds: _Nanoseconds


class _File(msgspec.Struct):
    path: str
    starting_time: _Moment
    duration: _Duration
    message_count: _Count


class _TopicMetadata(msgspec.Struct):
    name: str
    type: str
    offered_qos_profiles: Any = None
    type_description_hash: str = ""


class _Topic(msgspec.Struct):
    topic_metadata: _TopicMetadata
    message_count: _Count


class _Content(msgspec.Struct):
    topics_with_message_count: list[_Topic]
    files: list[_File]
    custom_data: dict[str, Any] | None = None
    ros_distro: str | None = None
