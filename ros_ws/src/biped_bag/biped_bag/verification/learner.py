"""The learner as it stood when a recorded run began, out of what the bag says of it."""

from __future__ import annotations

import tempfile
from pathlib import Path

from biped_bag.errors import BagError
from biped_bag.records import FROM_NOTHING, RUN_RECORD
from biped_bag.storage.reader import BagReader
from biped_common.plain_yaml import read_yaml
from biped_common.settings import SettingsError, from_mapping
from learner_node.checkpoint import CheckpointError, read_checkpoint, taking_over
from learner_node.walking.session import LearningSession
from learner_node.walking.settings import LearnerSettings
from trajectory_node.settings import GaitSettings


def recorded_session(bag: BagReader) -> LearningSession:
    """Return the learner with the recorded settings, seed and checkpoint.

    Raises:
        BagError: the bag does not say how the run began, or with settings and a memory
            of another version of this program.
    """
    record = next(bag.records(RUN_RECORD), None)
    if record is None:
        raise BagError(
            f"{bag.path}: has no record {RUN_RECORD}, which says with which settings "
            "and which seed the run began"
        )
    try:
        values = read_yaml(record.metadata["settings"])
        gait, learner = values["gait"], values["learner"]
        seed, begins_with = int(record.metadata["seed"]), record.metadata["begins_with"]
        if seed < 0:
            raise ValueError(f"seed {seed}")
    except (KeyError, TypeError, ValueError) as error:
        reason = " ".join(repr(error).split())[:200]
        raise BagError(f"{bag.path}: its record {RUN_RECORD}: {reason}") from None
    try:
        walk_ticks = from_mapping(GaitSettings, gait).walk_ticks
        settings = from_mapping(LearnerSettings, learner)
    except SettingsError as error:
        raise BagError(
            f"{bag.path}: was recorded by another version, with settings that this one "
            f"does not have ({error})"
        ) from None
    session = LearningSession(settings, walk_ticks, seed)
    if begins_with != FROM_NOTHING:
        _restore(session, bag, begins_with)
    return session


def _restore(session: LearningSession, bag: BagReader, name: str) -> None:
    attachment = next((a for a in bag.attachments() if a.name == name), None)
    if attachment is None:
        raise BagError(
            f"{bag.path}: the run began with {name}, which is not in the bag"
        )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "memory.npz"
        file.write_bytes(attachment.data)
        try:
            with taking_over(file):
                session.restore(*read_checkpoint(file))
        except CheckpointError as error:
            reason = str(error).replace(str(file), name)
            raise BagError(f"{bag.path}: attachment {reason}") from None
