"""Files of runs that are damaged, and a disk that is full: told, and mended."""

import subprocess

import pytest
from tests.thorough import first_always

from biped_lab.progress import StudyWatch
from biped_lab.run_folder import (
    COST_FILE,
    END_FILE,
    EPISODES_FILE,
    MEMORY_FILE,
    RUN_FILE,
    is_done,
)

from .studies import WALKS, carried_out, left_behind, planned

REMOVE = "remove the run's folder, and it begins anew"


def truncate(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@pytest.mark.parametrize("name", first_always([RUN_FILE, MEMORY_FILE, COST_FILE]))
def test_a_truncated_file_of_an_unfinished_run_is_told_and_the_others_go_on(lab, name):
    damaged, other = planned(lab, WALKS)
    for run in (damaged, other):
        (run / END_FILE).unlink()
    truncate(damaged / name)
    (failure,) = carried_out(lab, WALKS)
    assert failure.folder == damaged
    assert str(damaged / name) in failure.reason
    assert failure.reason.endswith(REMOVE)
    assert is_done(other)


@pytest.mark.parametrize("name", [END_FILE, EPISODES_FILE])
def test_a_truncated_file_of_a_run_that_is_done_is_told(lab, name):
    damaged, _ = planned(lab, WALKS)
    truncate(damaged / name)
    (failure,) = carried_out(lab, WALKS)
    assert failure.folder == damaged
    assert str(damaged / name) in failure.reason
    assert failure.reason.endswith(REMOVE)


@pytest.mark.parametrize("name", [END_FILE, COST_FILE])
def test_progress_is_shown_of_the_runs_that_are_not_damaged(lab, name):
    truncate(planned(lab, WALKS)[0] / name)
    assert [arm.done for arm in StudyWatch(lab, "small").arms()] == [0, 1]


@pytest.fixture
def small_disk(tmp_path):
    """A disk with room for plans, but not for a memory; grows when asked to."""
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("nothing can be mounted here")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.thorough
def test_a_full_disk_is_told_and_with_more_room_the_study_goes_on(
    small_disk, is_the_same
):
    failures = carried_out(small_disk, WALKS)
    assert len(failures) == len(planned(small_disk, WALKS))
    for failure in failures:
        assert "No space left on device" in failure.reason
    assert left_behind(small_disk) == []
    grow = ["mount", "-o", "remount,size=64m", str(small_disk)]
    subprocess.run(grow, check=True)
    assert carried_out(small_disk, WALKS) == []
    assert is_the_same(small_disk)
