"""The command line on every engine, and without what an engine would need."""

import subprocess
import sys

import pytest
from tests.biped_bringup.runs import SHORT, learn, quick, record

from sim_node.engines import ENGINES

KINEMATIC = ("--set", "sim.engine=kinematic")
MUJOCO = ("--set", "sim.engine=mujoco")
# As on a Python for which there are no wheels of PyBullet, without the extra.
WITHOUT_ENGINES = """
import sys
sys.modules["pybullet"] = sys.modules["mujoco"] = None
import sim_node.node  # all that the graph would need
from biped_bringup.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


def run_without_engines(folder, *arguments) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", WITHOUT_ENGINES, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_the_static_walk_fails_on_the_kinematic_engine_too(biped):
    outcome = biped("walk", "--static", "--json", *KINEMATIC)
    assert (outcome.status, outcome.values["end_cause"]) == (1, "zmp_error")
    assert outcome.values["t_err_terms"]["joint_torque"] == 0.0


@pytest.mark.parametrize("engine", [KINEMATIC, MUJOCO], ids=["kinematic", "mujoco"])
def test_a_walk_is_learned_on_one_engine_and_walked_on_all(biped, engine):
    short = [word for change in SHORT for word in ("--set", change)]
    learned = biped("learn", "--preset", "quick", *short, *engine, "--out", "out")
    assert learned.status == 0
    for engine in ENGINES:
        changed = ("--set", f"sim.engine={engine}")
        walked = biped("walk", "--json", "--memory", "out/memory.npz", *changed)
        assert (walked.status, walked.values["completed"]) == (0, True)


@pytest.mark.parametrize("engine", ["kinematic", "mujoco"])
def test_a_run_on_another_engine_goes_on_bit_for_bit(training, tmp_path, engine):
    settings = quick(f"sim.engine={engine}", "sim.disturbances.push_force_n=5")
    whole = learn(training(settings), 8)
    half = learn(training(settings), 4)
    half.save(tmp_path / "memory.npz")
    resumed = learn(training(tmp_path / "memory.npz"), 8)
    assert record(resumed) == record(whole)


def test_a_disturbance_without_effect_is_refused_in_one_line(biped):
    outcome = biped("check", *KINEMATIC, "--set", "sim.disturbances.friction=0.5")
    assert (outcome.status, outcome.err) == (
        2,
        "biped check: sim.disturbances.friction = 0.5: must be 0.9: it has no effect "
        "with engine = kinematic\n",
    )


def test_a_servo_that_an_engine_has_not_is_refused_in_one_line(biped):
    outcome = biped("check", *KINEMATIC, "--set", "sim.servo.kind=pid")
    assert (outcome.status, outcome.err) == (
        2,
        "biped check: sim.servo.kind = 'pid': must be one of ideal with engine = "
        "kinematic\n",
    )


@pytest.mark.parametrize("verb", [("walk", "--static"), ("learn", "--out", "run")])
def test_a_real_robot_is_walked_by_nodes_only(biped, verb):
    robot = ("sim.engine=robot", "sim.observations=sensors")
    outcome = biped(*verb, *(word for each in robot for word in ("--set", each)))
    assert outcome.status == 2
    assert "a real one is walked by `biped up`" in outcome.err.splitlines()[-1]


def test_an_unknown_engine_is_refused_with_those_there_are(biped):
    outcome = biped("check", "--set", "sim.engine=bullet")
    assert outcome.status == 2
    assert (
        "sim.engine = 'bullet': must be one of pybullet, mujoco, kinematic"
        in outcome.err
    )


# -- without PyBullet and MuJoCo -------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ("walk", "--static", "--set", "sim.limits.zmp_error_m=1.0"),
        ("learn", "--preset", "quick", "--set", "gait.steps=1", "--out", "out"),
    ],
    ids=["walk", "learn"],
)
def test_the_kinematic_engine_needs_no_pybullet(tmp_path, arguments):
    done = run_without_engines(tmp_path, *arguments, *KINEMATIC)
    assert done.returncode == 0, done.stderr


@pytest.mark.thorough
def test_an_engine_that_is_not_installed_is_refused_in_one_line(tmp_path):
    done = run_without_engines(tmp_path, "walk", "--static")
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert done.stderr.startswith("biped walk: sim.engine = 'pybullet': cannot be ")


def test_an_engine_of_an_extra_is_refused_with_what_brings_it(tmp_path):
    done = run_without_engines(tmp_path, "walk", "--static", *MUJOCO)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert done.stderr.startswith("biped walk: sim.engine = 'mujoco': cannot be ")
    assert "pip install 'biped[mujoco]'" in done.stderr
