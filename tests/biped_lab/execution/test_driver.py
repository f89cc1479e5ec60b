"""Who has runs carried out: failures are told, the others go on, drivers share."""

import fcntl
import itertools
import json
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import pytest

from biped_common.exclusive_folder import LOCK_FILE
from biped_lab.execution import new_stop_file, processes
from biped_lab.run_folder import is_done, is_taken, read_cost, read_end

from .studies import WALKS, carried_out, left_behind, odd, planned


def test_a_run_that_raises_is_told_in_a_line_with_the_place(tmp_path, odd_contestants):
    (failure,) = carried_out(tmp_path, odd(good="none", bad="raise"))
    assert failure.reason.startswith("ZeroDivisionError: one leg too few")
    assert "odd_contestants.py, line" in failure.reason


@pytest.mark.thorough
def test_a_sitting_carries_out_the_first_seeds_and_no_more(tmp_path, biped):
    study = tmp_path / "walks.yaml"
    study.write_text(json.dumps(WALKS | {"seeds": {"first": 1, "count": 3}}))
    done = biped("lab", "run", study, "--seeds", "1", "--out", tmp_path / "lab")
    assert done.status == 0
    assert "walks: 2 of 2 runs done" in done.out
    assert sum(is_done(run) for run in (tmp_path / "lab" / "runs").iterdir()) == 2


def test_a_run_that_raises_leaves_the_others_of_its_job_alone(
    tmp_path, odd_contestants
):
    study = odd(seeds=2, bad="raise", good="none")
    carried_out(tmp_path, study, per_job=4)
    assert [is_done(run) for run in planned(tmp_path, study)] == [False, True] * 2


@pytest.mark.thorough
def test_a_run_that_takes_its_worker_with_it_is_given_up_and_the_others_are_done(
    tmp_path, odd_contestants
):
    study = odd(bad="die", good="none")
    (failure,) = carried_out(tmp_path, study, partial(processes, 1))
    bad, good = planned(tmp_path, study)
    assert failure.folder == bad
    assert "its worker was lost 3 times" in failure.reason
    assert is_done(good)


def test_a_worker_computes_with_one_thread(tmp_path, odd_contestants):
    carried_out(tmp_path, odd(good="none"))
    (run,) = planned(tmp_path, odd(good="none"))
    assert read_end(run).figures == {"threads": 1}


def test_a_run_that_another_driver_carries_out_is_waited_for(tmp_path, odd_contestants):
    study = odd(good="none")
    (run,) = planned(tmp_path, study)
    looks = itertools.count()
    other = (run / LOCK_FILE).open("w")
    fcntl.flock(other, fcntl.LOCK_EX)

    def watch():
        if next(looks) == 2:  # the other driver stops, with the run unfinished
            other.close()

    assert carried_out(tmp_path, study, watch=watch) == []
    assert is_done(run)


def test_two_drivers_in_one_folder_share_the_runs(tmp_path, odd_contestants):
    study = odd(seeds=6, good="none")
    drivers = ThreadPoolExecutor(2)
    failures = list(drivers.map(lambda _: carried_out(tmp_path, study), range(2)))
    assert failures == [[], []]
    sittings = [read_cost(run).sittings for run in planned(tmp_path, study)]
    assert sittings == [1] * 6


@pytest.mark.thorough
def test_a_stopped_study_goes_on_to_the_same_end(tmp_path, is_the_same):
    stop = threading.Event()

    def watch():
        if any(read_cost(run).episodes > 2 for run in planned(tmp_path, WALKS)):
            stop.set()

    carried_out(tmp_path, WALKS, stop_asked=stop.is_set, watch=watch)
    assert not all(map(is_done, planned(tmp_path, WALKS)))
    assert left_behind(tmp_path) == []
    carried_out(tmp_path, WALKS)
    assert is_the_same(tmp_path)


def test_a_stop_file_of_a_driver_that_was_killed_stops_nobody(
    tmp_path, odd_contestants
):
    new_stop_file(tmp_path).touch()
    carried_out(tmp_path, odd(good="none"))
    assert all(map(is_done, planned(tmp_path, odd(good="none"))))
    assert left_behind(tmp_path) == []


def test_what_a_killed_worker_left_behind_is_removed(tmp_path, odd_contestants):
    (run,) = planned(tmp_path, odd(good="none"))
    (run / LOCK_FILE).write_text("1")
    (run / ".memory.npz.ab12cd34").touch()
    assert not is_taken(run)
    carried_out(tmp_path, odd(good="none"))
    assert left_behind(tmp_path) == []


def test_a_driver_that_fails_stops_its_workers_first(tmp_path, odd_contestants):
    def watch():
        raise LookupError("no display")

    study = odd(good="none") | {"most_episodes": 1_000_000}
    with pytest.raises(LookupError):
        carried_out(tmp_path, study, watch=watch)
    assert not any(map(is_taken, planned(tmp_path, study)))
