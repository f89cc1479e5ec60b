"""The learner of a recorded run, out of the bag's own record, or a clear refusal."""

import pytest
import yaml

from biped_bag.errors import BagError
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_bag.verification.learner import recorded_session
from biped_bringup.run_settings import load_settings
from biped_common.settings import to_mapping

SEED = 5


def bag_of_run(folder, **record):
    """Return a bag that says of its run what a recorder writes, but for `record`."""
    settings = yaml.safe_dump(to_mapping(load_settings("quick")))
    run = {"settings": settings, "seed": str(SEED), "begins_with": "nothing"} | record
    BagWriter(folder / "bag", records={"biped.run": run}).close()
    return BagReader(folder / "bag")


def test_settings_and_seed_are_those_of_the_record(tmp_path):
    session = recorded_session(bag_of_run(tmp_path))
    assert session.settings == load_settings("quick").learner
    assert session.seed == SEED


def test_settings_of_another_version_are_refused_by_the_bag_s_name(tmp_path):
    bag = bag_of_run(tmp_path, settings="gait: {}\nlearner: {pace: 3}")
    with pytest.raises(BagError, match=r"bag: was recorded by another.*pace = 3"):
        recorded_session(bag)


def test_a_record_without_settings_is_refused(tmp_path):
    with pytest.raises(BagError, match=r"bag: its record biped\.run: KeyError"):
        recorded_session(bag_of_run(tmp_path, settings="{}"))


def test_a_memory_that_is_not_attached_is_named(tmp_path):
    bag = bag_of_run(tmp_path, begins_with="memory.npz")
    with pytest.raises(BagError, match=r"began with memory\.npz, which is not in the"):
        recorded_session(bag)
