"""What a bag holds: as `ros2 bag info` prints it, and what it tells of its run."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from mcap.records import Metadata

from biped_bag.records import EPISODE_RECORD, RUN_RECORD
from biped_bag.storage.contents import BagTopic
from biped_bag.storage.reader import BagReader
from biped_common.terminal_text import printable
from biped_common.timing import NS_PER_S

_LABEL_WIDTH = 19
_SIZE_UNITS = ("B", "KiB", "MiB", "GiB", "TiB")
# With service introspection switched on, calls are recorded as topics like this.
_SERVICE_TOPIC, _SERVICE_TYPE = "/_service_event", "_Event"
_EPISODES_SHOWN = 20


def info_text(bag: BagReader) -> str:
    """Return the text of `ros2 bag info`, without a newline at its end."""
    topics = [topic for topic in _sorted(bag) if not _of_service(topic)]
    services = [topic for topic in _sorted(bag) if _of_service(topic)]
    indent = "\n" + " " * _LABEL_WIDTH
    lines = {
        "Files:": indent.join(file.name for file in bag.files),
        "Bag size:": _size_text(bag.size),
        "Storage id:": "mcap",
        "ROS Distro:": bag.ros_distro or "unknown",
        "Duration:": f"{_seconds_text(bag.duration_ns)}s",
        "Start:": _moment_text(bag.start_ns),
        "End:": _moment_text(bag.end_ns),
        "Messages:": str(sum(topic.count for topic in topics)),
        "Topic information:": indent.join(map(_topic_text, topics)),
        "Service:": str(len(services)),
    }
    text = "".join(
        f"\n{label:<{_LABEL_WIDTH}}{value}" for label, value in lines.items()
    )
    service_text = f"{indent}  ".join(map(_service_text, services))
    return f"{text}\nService information: {service_text}"


def run_text(bag: BagReader) -> str:
    """Return what the bag tells of its run and its episodes; empty if nothing."""
    run = next(bag.records(RUN_RECORD), None)
    episodes = list(bag.records(EPISODE_RECORD))
    lines = [] if run is None else [_line("Run:", _summary_of_run(run))]
    if episodes:
        causes = Counter(record.metadata.get("end_cause", "?") for record in episodes)
        counts = ", ".join(f"{cause} {n}" for cause, n in causes.most_common())
        lines.append(_line("Episodes:", f"{len(episodes)} ({counts})"))
        if len(episodes) > _EPISODES_SHOWN:
            lines.append(_line("", f"the last {_EPISODES_SHOWN}; --json lists all"))
        shown = episodes[-_EPISODES_SHOWN:]
        lines += [_line("", _episode_text(record)) for record in shown]
    return "\n".join(lines)


def info_mapping(bag: BagReader) -> dict[str, Any]:
    """Return the same for scripts."""
    return {
        "files": [file.name for file in bag.files],
        "bag_size_bytes": bag.size,
        "storage_id": "mcap",
        "ros_distro": bag.ros_distro,
        "duration_ns": bag.duration_ns,
        "start_ns": bag.start_ns,
        "end_ns": bag.end_ns,
        "messages": bag.message_count,
        "topics": [
            {
                "name": topic.name,
                "type": topic.type_name,
                "count": topic.count,
                "serialization_format": topic.encoding,
                "latched": topic.latched,
            }
            for topic in _sorted(bag)
        ],
        "run": next((r.metadata for r in bag.records(RUN_RECORD)), None),
        "episodes": [record.metadata for record in bag.records(EPISODE_RECORD)],
        "attachments": [attachment.name for attachment in bag.attachments()],
    }


def _sorted(bag: BagReader) -> Sequence[BagTopic]:
    return sorted(bag.topics.values(), key=lambda topic: topic.name)


def _of_service(topic: BagTopic) -> bool:
    return topic.name.endswith(_SERVICE_TOPIC) and topic.type_name.endswith(
        _SERVICE_TYPE
    )


def _topic_text(topic: BagTopic) -> str:
    return printable(
        f"Topic: {topic.name} | Type: {topic.type_name} | Count: {topic.count} | "
        f"Serialization Format: {topic.encoding}"
    )


def _service_text(topic: BagTopic) -> str:
    return printable(
        f"Service: {topic.name.removesuffix(_SERVICE_TOPIC)} | "
        f"Type: {topic.type_name.removesuffix(_SERVICE_TYPE)} | "
        f"Event Count: {topic.count} | Serialization Format: {topic.encoding}"
    )


def _size_text(size: int) -> str:
    value, unit = float(size), 0
    while value >= 1024 and unit < len(_SIZE_UNITS) - 1:
        value, unit = value / 1024, unit + 1
    return f"{value:.{1 if unit else 0}f} {_SIZE_UNITS[unit]}"


def _seconds_text(duration_ns: int) -> str:
    whole, rest = divmod(duration_ns, NS_PER_S)
    return f"{whole}.{rest:09d}"


def _moment_text(moment_ns: int) -> str:
    """Return local time and seconds of the epoch."""
    whole, rest = divmod(moment_ns, NS_PER_S)
    local = time.strftime("%b %e %Y %H:%M:%S", time.localtime(whole))
    return f"{local}.{rest:09d} ({_seconds_text(moment_ns)})"


def _line(label: str, value: str) -> str:
    return f"{label:<{_LABEL_WIDTH}}{printable(value)}"


def _summary_of_run(run: Metadata) -> str:
    values = run.metadata
    commit = values.get("git_commit", "")
    changed = ", with changes" if values.get("git_dirty") == "true" else ""
    git = f"commit {commit}{changed}" if commit else "not from a git checkout"
    preset = values.get("preset", "")
    of_preset = f", preset {preset}" if preset else ""
    return f"seed {values.get('seed', 'unknown')}{of_preset}, {git}"


def _episode_text(record: Metadata) -> str:
    values = record.metadata
    return " | ".join(
        (
            f"Episode: {values.get('episode', '?')}",
            f"End cause: {values.get('end_cause', '?')}",
            f"Control ticks: {values.get('control_ticks', '?')}"
            f" of {values.get('target_ticks', '?')}",
        )
    )
