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
How losses are counted, see `losses`; a finished `metadata.yaml` counts, too. Without an
end, messages that the recorder had not yet handed to the system (at most 0.1 s) leave
no trace: the report says that the end is missing.
"""

from __future__ import annotations

from pathlib import Path

from biped_bag.bag_files import data_files
from biped_bag.copying import new_bag, refuse_existing
from biped_bag.errors import BagError
from biped_bag.file_recovery import FileRecovery
from biped_bag.mcap_check import UnusableFileError, mapped
from biped_bag.metadata import BagMetadata, read_metadata
from biped_bag.recovered_bag import RecoveredBag
from biped_bag.recovery_report import RecoveryReport


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
    try:
        files = data_files(bag) if bag.is_dir() else (bag,)
        with new_bag(out) as writer:
            recovered = RecoveredBag(report, writer, _metadata(bag))
            before = unusable = 0
            for file in files:
                before = report.recovered
                try:
                    with mapped(file) as content:
                        FileRecovery(recovered, file, content).run()
                except UnusableFileError as error:
                    report.damage.append(str(error))
                    report.end_known = False
                    unusable += 1
            recovered.compare(files, report.recovered - before)
            if not report.recovered and not report.nothing_lost:
                why = report.damage[-1] if unusable == len(files) else ""
                raise BagError(why or f"{bag}: holds no message that is whole")
            written = writer.metadata
            report.duration_s = 1e-9 * (written.end_ns - written.start_ns)
            writer.close({"recovered_from": bag.name})
    except BagError as error:
        raise RecoveryFailedError(str(error)) from None
    return report


def _metadata(bag: Path) -> BagMetadata | None:
    try:
        return read_metadata(bag) if bag.is_dir() else None
    except BagError:
        return None
