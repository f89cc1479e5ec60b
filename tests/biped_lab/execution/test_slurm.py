"""Studies as jobs of a SLURM cluster; here it has one node, this machine."""

import subprocess
import tempfile
from functools import partial
from pathlib import Path

import pytest

from biped_common.command_line import CommandError
from biped_lab.run_folder import is_done, is_taken, read_cost
from biped_lab.slurm_cluster import slurm

from .slurm_here import is_installed, slurm_here, wait_for
from .studies import WALKS, carried_out, left_behind, odd, planned

pytestmark = pytest.mark.skipif(
    not is_installed(), reason="slurmctld, slurmd, slurm-client and munge are not here"
)


@pytest.fixture(scope="module")
def conf():
    with (
        tempfile.TemporaryDirectory(prefix="slurm") as folder,
        slurm_here(Path(folder)) as conf,
    ):
        yield conf


@pytest.fixture
def cluster(conf, tmp_path, monkeypatch):
    """Opens the way to the cluster; SLURM is asked about jobs every second."""
    monkeypatch.setenv("SLURM_CONF", str(conf))
    monkeypatch.setattr("biped_lab.slurm_cluster._ASK_SQUEUE_S", 1.0)
    return partial(slurm, tmp_path / "slurm", None, 30, {})


def queued():
    """The numbers of the jobs that wait or run."""
    asked = subprocess.run(
        ["squeue", "--me", "--noheader", "--format=%i"],
        capture_output=True,
        text=True,
        check=True,
        timeout=60.0,
    )
    return asked.stdout.split()


@pytest.mark.thorough
def test_jobs_carry_a_study_out_though_one_is_ended_in_the_middle(
    cluster, tmp_path, is_the_same
):
    runs = planned(tmp_path, WALKS)
    ended = []

    def watch():
        if not ended and read_cost(runs[0]).episodes > 3:
            ended.append(queued()[0])
            # As SLURM itself does at the time limit, or for a job of higher priority.
            subprocess.run(["scancel", *ended], check=True, timeout=60.0)

    assert carried_out(tmp_path, WALKS, cluster, watch=watch, per_job=2) == []
    assert ended
    assert read_cost(runs[0]).sittings == 2
    assert is_the_same(tmp_path)
    assert left_behind(tmp_path / "runs") == []


@pytest.mark.thorough
def test_a_stopped_study_takes_its_jobs_out_of_the_queue(cluster, tmp_path):
    study = WALKS | {"settings": {}, "most_episodes": 1_000}
    study |= {"seeds": {"first": 1, "count": 2}}  # four runs for two processors
    runs = planned(tmp_path, study)
    carried_out(
        tmp_path,
        study,
        cluster,
        stop_asked=lambda: any(read_cost(run).episodes > 0 for run in runs),
    )
    assert wait_for(lambda: not queued())  # what ran is just ending
    assert not any(map(is_taken, runs))
    assert not any(map(is_done, runs))
    assert not all(read_cost(run).sittings for run in runs)


def test_a_job_that_sbatch_refuses_is_told(cluster, tmp_path, odd_contestants):
    elsewhere = partial(slurm, tmp_path / "slurm", "no_such_partition", 30, {})
    with pytest.raises(CommandError, match=r"sbatch refuses: .*partition"):
        carried_out(tmp_path, odd(good="none"), elsewhere)
