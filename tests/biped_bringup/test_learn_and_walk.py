"""`biped learn` and `biped walk` as a script uses them: JSON, files, exit status."""

import csv
import json
import struct
from pathlib import Path

import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.training import TrainingRun
from biped_common.settings import to_mapping

SHORT_CHANGES = [word for change in SHORT for word in ("--set", change)]
SHORT_LEARN = (
    *("learn", "--json", "--preset", "quick", "--out", "out"),
    *SHORT_CHANGES,
)
SHORT_STATIC = ("walk", "--json", "--static", "--set", "gait.steps=1")
STATIC = ("walk", "--json", "--static")

LEARN_KEYS = {
    "completed",
    "target_time_s",
    "episodes",
    "simulated_s",
    "cpu_s",
    "replay_off",
    "computed_ticks",
    "replayed_ticks",
    "figures",
    "memory_sha256",
    "trajectory_sha256",
    "memory_file",
}
WALK_KEYS = {
    "end_cause",
    "end_time_s",
    "completed",
    "peak_zmp_error_m",
    "peak_joint_velocity_rad_s",
    "t_err",
    "t_err_terms",
    "trajectory_sha256",
}
TERMS = [
    "zmp",
    "final_zmp",
    "joint_tracking",
    "joint_torque",
    "final_joint_position",
    "final_joint_velocity",
]


def png_size(file: Path) -> tuple[int, int]:
    """Width and height of a PNG [pixels]."""
    head = file.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


# -- learning ----------------------------------------------------------------------


def test_what_is_learned_in_one_process_is_walked_in_another(biped_process):
    learned = biped_process(*SHORT_LEARN)
    assert (learned.status, learned.values["completed"]) == (0, True)
    memory_file = learned.values["memory_file"]
    walked = biped_process("walk", "--json", "--memory", memory_file)
    assert (walked.status, walked.values["completed"]) == (0, True)


def test_standard_output_of_a_process_is_one_json_object(biped_process):
    outcome = biped_process(*SHORT_LEARN, "--episodes", 1)
    assert json.loads(outcome.out).keys() >= LEARN_KEYS


def test_episodes_that_run_out_are_no_success(biped):
    outcome = biped(*SHORT_LEARN, "--episodes", 2)
    assert (outcome.status, outcome.values["completed"]) == (1, False)
    assert outcome.values["episodes"] == 2


def test_learning_can_end_with_the_schedule(biped):
    outcome = biped(*SHORT_LEARN, "--stop-at-schedule")
    assert outcome.status == 0
    assert outcome.values["schedule_episodes"] == outcome.values["episodes"]


def test_the_figures_of_a_run_fit_together(biped):
    values = biped(*SHORT_LEARN).values
    assert values["target_time_s"] == 3.75
    assert 0 < values["simulated_s"] <= values["episodes"] * values["target_time_s"]
    figures = values["figures"]
    assert (
        figures["fixed_states"] + figures["penalty_states"] <= figures["basis_states"]
    )
    assert values["cpu_s"] > 0.0


def test_the_reported_hashes_are_those_of_the_memory(biped):
    values = biped(*SHORT_LEARN, "--episodes", 2).values
    run = TrainingRun.load(Path(values["memory_file"]))
    run.close()
    assert values["memory_sha256"] == run.session.memory_sha256()
    assert values["trajectory_sha256"] == run.tally.trajectories_sha256


def test_the_seed_is_zero_unless_given(biped):
    first, second = (
        biped(*SHORT_LEARN, "--fresh", "--episodes", 1, *seed).values["memory_sha256"]
        for seed in ((), ("--seed", 0))
    )
    assert first == second


def test_what_was_learned_before_is_not_overwritten(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 1)
    before = (tmp_path / "out" / "memory.npz").read_bytes()
    outcome = biped(*SHORT_LEARN, "--episodes", 1)
    assert outcome.status == 2
    assert "is there already" in outcome.err
    assert (tmp_path / "out" / "memory.npz").read_bytes() == before


def test_the_json_of_a_run_has_its_settings(biped):
    values = biped(*SHORT_LEARN, "--episodes", 1).values
    assert values["settings"] == to_mapping(quick(*SHORT))


def test_the_log_has_a_row_per_episode(biped, tmp_path):
    episodes = biped(*SHORT_LEARN, "--episodes", 3).values["episodes"]
    with (tmp_path / "out" / "episodes.csv").open() as log:
        rows = list(csv.DictReader(log))
    assert [int(row["episode"]) for row in rows] == list(range(1, episodes + 1))


def test_nothing_but_memory_and_log_is_left_behind(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 2, "--checkpoint-every", 0)
    left = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert left == ["episodes.csv", "memory.npz"]


def test_a_resumed_run_stays_in_its_folder(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 1)
    resumed = biped("learn", "--json", "--resume", "out/memory.npz", "--episodes", 2)
    assert resumed.values["memory_file"] == "out/memory.npz"
    assert [file.name for file in tmp_path.iterdir()] == ["out"]


def test_a_resumed_run_can_go_to_another_folder(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 1)
    memory = (tmp_path / "out" / "memory.npz").read_bytes()
    biped("learn", "--resume", "out/memory.npz", "--out", "more", "--episodes", 2)
    assert (tmp_path / "more" / "memory.npz").exists()
    assert (tmp_path / "out" / "memory.npz").read_bytes() == memory


def test_a_learned_run_that_is_resumed_has_nothing_to_do(biped, tmp_path):
    biped(*SHORT_LEARN)
    before = (tmp_path / "out" / "memory.npz").read_bytes()
    resumed = biped("learn", "--resume", "out/memory.npz", "--out", "more")
    assert (resumed.status, resumed.err) == (0, "")
    assert resumed.out == "nothing to do with out/memory.npz: the walk is learned\n"
    assert (tmp_path / "out" / "memory.npz").read_bytes() == before
    assert not (tmp_path / "more").exists()


def test_a_run_that_has_walked_all_its_episodes_has_nothing_to_do(biped):
    biped(*SHORT_LEARN, "--episodes", 2)
    resumed = biped("learn", "--resume", "out/memory.npz", "--episodes", 2)
    assert resumed.status == 1
    assert resumed.out.endswith(": 2 of at most 2 episodes are walked\n")


def test_on_the_graph_nodes_with_nothing_to_do_are_not_started(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 2)
    files = sorted(tmp_path.rglob("*"))
    resumed = biped("up", "--resume", "--out", "out", "--episodes", 2)
    assert resumed.status == 1
    assert resumed.out.endswith(": 2 of at most 2 episodes are walked\n")
    assert sorted(tmp_path.rglob("*")) == files


def test_a_learned_run_goes_on_under_other_settings_and_says_so(biped):
    episodes = biped(*SHORT_LEARN).values["episodes"]
    pushed = ("--set", "sim.disturbances.push_force_n=10")
    resume = ("learn", "--json", "--resume", "out/memory.npz", "--out", "pushed")
    resumed = biped(*resume, *pushed, "--episodes", episodes + 1)
    assert "not bit for bit: sim.disturbances.push_force_n 0.0 -> 10.0" in resumed.err
    assert resumed.values["episodes"] == episodes + 1
    settings = resumed.values["settings"]
    assert settings["sim"]["disturbances"]["push_force_n"] == 10.0
    again = biped("learn", "--json", "--resume", "pushed/memory.npz", "--episodes", 1)
    assert again.values["settings"] == settings


def test_without_json_a_run_is_reported_in_words(biped):
    words = [word for word in SHORT_LEARN if word != "--json"]
    out = biped(*words).out
    assert out.startswith("learned: a frozen greedy walk completes the whole walk\n")
    assert "out/memory.npz" in out


# -- walking -----------------------------------------------------------------------


def test_a_static_walk_leaves_its_zmp_limit_in_the_first_step(biped):
    outcome = biped(*STATIC)
    assert outcome.status == 1
    assert outcome.values["end_cause"] == "zmp_error"
    assert 2.0 <= outcome.values["end_time_s"] <= 2.4


@pytest.mark.parametrize(
    ("double_support_s", "end_cause"),
    [(1.05, "completed"), (0.9, "completed"), (0.8, "feet_unloaded")],
)
def test_a_static_walk_without_its_zmp_limit_falls_only_with_short_double_supports(
    biped, double_support_s, end_cause
):
    lifted = ("--set", "sim.limits.zmp_error_m=1.0")
    walk = biped(*STATIC, "--tds", double_support_s, *lifted).values
    assert walk["end_cause"] == end_cause


def test_a_static_walk_with_more_double_support_is_completed(biped):
    outcome = biped(*STATIC, "--tds", 1.3)
    assert outcome.status == 0
    assert outcome.values["end_cause"] == "completed"
    assert outcome.values["end_time_s"] == 11.25


def test_a_walk_is_reported_with_these_keys(biped):
    assert biped(*SHORT_STATIC).values.keys() >= WALK_KEYS


def test_t_err_is_the_sum_of_its_six_terms(biped):
    values = biped(*SHORT_STATIC).values
    assert list(values["t_err_terms"]) == TERMS
    total = sum(values["t_err_terms"].values())
    assert values["t_err"] == pytest.approx(total, rel=1e-12)


def test_standard_output_of_a_walking_process_is_one_json_object(biped_process):
    outcome = biped_process(*SHORT_STATIC)
    assert json.loads(outcome.out).keys() >= WALK_KEYS


def test_tds_is_short_for_the_double_support_time(biped):
    short = biped(*SHORT_STATIC, "--tds", 1.3).values
    assert short == biped(*SHORT_STATIC, "--set", "gait.double_support_s=1.3").values


def test_without_disturbances_the_seed_of_a_walk_does_not_matter(biped):
    walks = [biped(*SHORT_STATIC, "--seed", seed).values for seed in (0, 1)]
    assert walks[0] == walks[1]


def test_the_seed_of_a_walk_draws_its_disturbances(biped):
    pushed = ("--set", "sim.disturbances.push_force_n=10")
    same, again, other = (
        biped(*SHORT_STATIC, *pushed, "--seed", seed).values["trajectory_sha256"]
        for seed in (4, 4, 5)
    )
    assert same == again != other


def test_a_memory_walks_as_it_was_learned(biped):
    learned = biped(*SHORT_LEARN).values
    run = TrainingRun.load(Path(learned["memory_file"]))
    greedy = run.greedy_walk()
    run.close()
    walked = biped("walk", "--json", "--memory", learned["memory_file"]).values
    assert walked["trajectory_sha256"] == greedy.trajectory_sha256


def test_walking_does_not_change_the_memory(biped, tmp_path):
    biped(*SHORT_LEARN, "--episodes", 1)
    memory = (tmp_path / "out" / "memory.npz").read_bytes()
    biped("walk", "--memory", "out/memory.npz")
    assert (tmp_path / "out" / "memory.npz").read_bytes() == memory


def test_a_memory_can_be_tried_on_another_engine_and_the_screen_says_so(biped):
    biped(*SHORT_LEARN, "--episodes", 1)
    walk = ("walk", "--memory", "out/memory.npz", "--set", "sim.engine=kinematic")
    assert "sim.engine pybullet -> kinematic" in biped(*walk).out


def test_without_json_a_walk_is_reported_in_words(biped):
    out = biped("walk", "--static", "--set", "gait.steps=1").out
    assert out.startswith("end                  completed after 3.750 s of 3.75 s\n")
    assert "peak ZMP error" in out
    assert "T_err" in out


@pytest.mark.parametrize("changes", [(), ("--set", "gait.steps=1")])
def test_the_figure_of_a_walk_is_a_picture(biped, tmp_path, changes):
    biped("walk", "--static", "--figure", "zmp.png", *changes)
    assert png_size(tmp_path / "zmp.png") == (1080, 1080)
    assert 20_000 < (tmp_path / "zmp.png").stat().st_size < 1_000_000


@pytest.mark.parametrize("name", ["zmp", "zmp.walk"])
def test_the_figure_is_drawn_where_it_was_asked_for_or_not_at_all(
    biped, tmp_path, name
):
    outcome = biped("walk", *SHORT_STATIC[2:], "--figure", name)
    drawn = [file.name for file in tmp_path.iterdir()]
    assert drawn == ([name] if outcome.status == 0 else [])
    assert outcome.status in (0, 2)
