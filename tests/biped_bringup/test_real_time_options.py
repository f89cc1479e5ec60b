"""What `biped up` is asked to keep real time by reaches the nodes, or is refused."""

import argparse

import pytest

from biped_bringup.cli.real_time import add_real_time_options, real_time_parameters
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings

NODES = ("sim_node", "trajectory_node", "learner_node")


def parameters(*words):
    """The nodes' parameters for these options."""
    parser = argparse.ArgumentParser()
    add_real_time_options(parser)
    given = real_time_parameters(parser.parse_args(words))
    return node_parameters(load_settings("quick"), 0, **given).flat()


def test_without_options_the_nodes_have_their_defaults():
    assert parameters() == node_parameters(load_settings("quick"), 0).flat()


def test_the_share_of_the_machine_is_that_of_all_three_nodes():
    words = ("--fifo", "50", "--nice", "-5", "--cores", "0,1", "--lock-memory")
    of = parameters(*words)
    expected = {
        "processor.fifo_priority": 50,
        "processor.nice": -5,
        "processor.cores": [0, 1],
        "processor.lock_memory": True,
    }
    for node in NODES:
        assert {name: of[node][name] for name in expected} == expected


def test_pace_and_look_ahead_go_where_they_belong():
    of = parameters("--factor", "0.5", "--look-ahead", "100")
    assert of["sim_node"]["realtime_factor"] == 0.5
    assert of["trajectory_node"]["look_ahead_ticks"] == 100


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--fifo 100", "--fifo 100: must be between 0 and 99"),
        ("--nice -21", "--nice -21: must be between -20 and 19"),
        ("--cores=-1", "--cores (-1,): must be at least 0"),
        ("--look-ahead 601", "--look-ahead 601: must be between 1 and 600"),
        (
            "--set sim.engine=robot --set sim.observations=sensors --look-ahead 49",
            "--look-ahead 49: must be 50 or more with sim.engine = robot",
        ),
        ("--factor 0", "--factor 0.0: must be above 0.0"),
        ("--factor nan", "--factor nan: must be a finite number"),
        ("--cores a", "--cores: a: must be whole numbers, as in 0,1"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(biped, words, said):
    outcome = biped("up", "--record", "none", *words.split())
    assert (outcome.status, outcome.out) == (2, "")
    assert said in outcome.err.splitlines()[-1]
