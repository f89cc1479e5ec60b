"""The bag that a recovery writes, and the report that grows with it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from mcap.records import Metadata

from biped_bag.copying import OWN_RECORD, add_topic
from biped_bag.metadata import BagMetadata
from biped_bag.reader import BagTopic
from biped_bag.recovery_report import RecoveryReport, TopicRecovery
from biped_bag.writer import BagWriter


@dataclass
class RecoveredBag:
    """All that is found, on its way into the new bag and into the report."""

    report: RecoveryReport
    writer: BagWriter
    told: BagMetadata | None
    """What metadata.yaml says, as of the bag's end or its last split."""
    _topics: dict[str, BagTopic] = field(default_factory=dict)
    _records: list[Metadata] = field(default_factory=list)

    def add_topic(self, topic: BagTopic) -> None:
        """Make a topic known to the new bag, once."""
        if topic.name not in self._topics:
            add_topic(self.writer, topic)
            self._topics[topic.name] = topic
            self.topic(topic.name)

    def add_record(self, record: Metadata) -> None:
        """Hand on a metadata record; every file of a bag repeats those of the run."""
        if record.name != OWN_RECORD and record not in self._records:
            self._records.append(record)
            self.writer.add_record(record.name, record.metadata)

    def topic(self, name: str) -> TopicRecovery:
        """Return the report of a topic."""
        return self.report.topics.setdefault(name, TopicRecovery())

    def told_end_ns(self, file: Path) -> int:
        """Return the last log time of a file as metadata.yaml says, or 0."""
        files = self.told.files if self.told else ()
        return max((info.end_ns for info in files if info.path == file.name), default=0)

    def compare(self, files: tuple[Path, ...], in_last_file: int) -> None:
        """Take the counts of metadata.yaml, if it was written when the bag ended.

        Args:
            files: of the broken bag that are there.
            in_last_file: messages recovered from the last of them.
        """
        if self.told is None or not self.told.files:
            return
        names = {file.name for file in files}
        for info in self.told.files:
            if info.path not in names:
                lost_s = 1e-9 * (info.end_ns - info.start_ns)
                self.report.damage.append(f"{info.path}: is missing, {lost_s:.3f} s")
        last = self.told.files[-1]
        # At its last split, all that the last file held was latched, and of one moment.
        finished = last.end_ns > last.start_ns and last.message_count >= in_last_file
        if not finished:
            return
        self.report.end_known = True
        for told in self.told.topics:
            topic = self.topic(told.name)
            topic.lost = max(0, told.message_count - topic.recovered)
            topic.exact = True
            topic.lost_s = topic.lost_s if topic.lost else 0.0
