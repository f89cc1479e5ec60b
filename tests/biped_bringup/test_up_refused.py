"""What `biped up` refuses: one line, status 2, and nothing left behind."""

import os
import re

import pytest

from biped_common.exclusive_folder import exclusive_folder

# What is typed behind `biped up --out out`, and what the line must say.
REFUSED = {
    "--domain 233": r"--domain 233: must be from 0 to 232",
    "--domain 300": r"--domain 300: must be from 0 to 232",
    "--publish-every 0": r"--publish-every 0: must be between 1 and 1000 control ticks",
    "--publish-every 1001": r"--publish-every 1001: must be between 1 and 1000",
    f"--seed {2**63}": rf"--seed {2**63}: must be between 0 and {2**63 - 1}",
    "--nodes sim,robot": r"--nodes sim,robot: must be among recorder,trajectory,",
    "--greedy": r"out/memory\.npz: no such file",
    "--resume": r"out/memory\.npz: no such file",
    "--set gait.step_length_m=0.45": r"cannot walk this gait",
    "--set gait.shoes=2": r"gait\.shoes = 2: unknown key",
}


def refusal(biped, *options):
    """The one line that a refused `biped up` says."""
    outcome = biped("up", *options)
    assert (outcome.status, outcome.out) == (2, "")
    (line,) = outcome.err.splitlines()
    assert line.startswith("biped up: ")
    return line


@pytest.mark.parametrize("line", REFUSED)
def test_it_is_refused_in_one_line_and_leaves_no_folder(biped, tmp_path, line):
    assert re.search(REFUSED[line], refusal(biped, "--out", "out", *line.split()))
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("domain", ["233", "-1", "home"])
def test_a_domain_of_the_environment_that_there_is_not_is_named(
    biped, monkeypatch, domain
):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    assert f"ROS_DOMAIN_ID {domain}: must be from 0 to 232" in refusal(biped)


@pytest.mark.parametrize("verb", ["up", "learn"])
def test_a_folder_in_which_a_run_is_is_refused(biped, tmp_path, verb):
    with exclusive_folder(tmp_path):
        outcome = biped(verb, "--out", tmp_path)
    assert (outcome.status, outcome.out) == (2, "")
    assert f"another run is in this folder, process {os.getpid()};" in outcome.err
    assert os.listdir(tmp_path) == []


def test_a_run_that_is_refused_leaves_the_memory_of_the_other(biped, tmp_path):
    memory = tmp_path / "memory.npz"
    memory.write_text("of the other")
    with exclusive_folder(tmp_path):
        refusal(biped, "--out", tmp_path, "--fresh")
    assert memory.read_text() == "of the other"
