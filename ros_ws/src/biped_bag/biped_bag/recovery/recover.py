"""Rewrite a broken bag into a sound one, and say exactly what was lost.

What is recovered:
    all messages of all chunks that are whole, in their order, with their times and
        numbers; topics with types, QoS and definitions; metadata records; attachments.
    Nothing else: a message of a damaged chunk cannot be told from noise.
What failures do:
    the file ends anywhere: everything before its last, torn record is recovered.
    bytes are damaged: the record that they are in is lost, all others are recovered,
        also where the damage hides how long the record was.
    the definition of a topic is lost (it stands in the first chunk and in the summary):
        messages of the topic count as lost.
    metadata.yaml is missing, damaged or out of date: the files are taken as they are.
    one of several files is empty or not MCAP: the others are recovered.
    all is damaged, or no file is MCAP: `RecoveryFailedError`, nothing is written.
    the output cannot be written: the same; what was begun is removed.
    the output is there already: `BagError`, it is never overwritten.
The broken bag is never changed.
How losses are counted, see `tally`; a finished `metadata.yaml` counts, too. Without an
end, messages that the recorder had not yet handed to the system (at most 0.1 s) leave
no trace: the report says that the end is missing.
The exit statuses that the command makes of this: `verbs/recover.py`.
"""

from __future__ import annotations

from pathlib import Path

from biped_bag.errors import BagError
from biped_bag.recovery.file import FileRecovery, RecoveredBag
from biped_bag.recovery.report import RecoveryReport
from biped_bag.storage.integrity import UnusableFileError, mapped
from biped_bag.storage.layout import data_files, refuse_existing
from biped_bag.storage.metadata import BagMetadata, read_metadata
from biped_bag.storage.writer import new_bag


class RecoveryFailedError(BagError):
    """Nothing could be recovered, or what was could not be written."""


def recover(bag: Path, out: Path) -> RecoveryReport:
    """Rewrite a broken bag.

    Args:
        bag: folder of a bag, with or without metadata.yaml, or a single MCAP file.
        out: folder of the bag to write; must not exist.

    Raises:
        RecoveryFailedError: there is nothing to recover, or no place for it.
        BagError: no such bag, or the output is there already.
    """
    if not bag.exists():
        raise BagError(f"{bag}: no such file or folder")
    refuse_existing(out)
    if bag.resolve() in out.resolve().parents:
        raise BagError(f"{out}: must not be inside the broken bag")
    report = RecoveryReport(str(bag), str(out))
    told = _told(bag)
    told_end_ns = {info.path: info.end_ns for info in told.files}
    try:
        files = data_files(bag) if bag.is_dir() else (bag,)
        with new_bag(out) as writer:
            recovered = RecoveredBag(report, writer)
            before = unusable = 0
            for file in files:
                before = report.recovered
                try:
                    with mapped(file) as content:
                        end_ns = told_end_ns.get(file.name, 0)
                        FileRecovery(recovered, file, content).run(end_ns)
                except UnusableFileError as error:
                    report.damage.append(str(error))
                    report.end_known = False
                    unusable += 1
            _compare(report, told, files, report.recovered - before)
            if not report.recovered and not report.nothing_lost:
                why = report.damage[-1] if unusable == len(files) else ""
                raise BagError(why or f"{bag}: holds no message that is whole")
            written = writer.metadata
            report.duration_s = 1e-9 * (written.end_ns - written.start_ns)
            writer.close({"recovered_from": bag.name})
    except BagError as error:
        raise RecoveryFailedError(str(error)) from None
    return report


def _told(bag: Path) -> BagMetadata:
    """Return what metadata.yaml says, as of the bag's end or its last split."""
    try:
        return read_metadata(bag) if bag.is_dir() else BagMetadata()
    except BagError:
        return BagMetadata()


def _compare(
    report: RecoveryReport,
    told: BagMetadata,
    files: tuple[Path, ...],
    in_last_file: int,
) -> None:
    """Take the counts of metadata.yaml, if it was written when the bag ended.

    Args:
        report: of what was recovered.
        told: by metadata.yaml.
        files: of the broken bag that are there.
        in_last_file: messages recovered from the last of them.
    """
    names = {file.name for file in files}
    for info in told.files:
        if info.path not in names:
            lost_s = 1e-9 * (info.end_ns - info.start_ns)
            report.damage.append(f"{info.path}: is missing, {lost_s:.3f} s")
    for last in told.files[-1:]:
        # At its last split, all that the last file held was latched, of one moment.
        if last.end_ns > last.start_ns and last.message_count >= in_last_file:
            report.end_known = True
            for topic in told.topics:
                report.topic(topic.name).settle(topic.count)
