"""Wrong input: exit status 2, and one line that says what is wrong."""

import re

import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.training import TrainingRun

# What is typed, and what the line must say.
REFUSED = {
    "check --set gait.shoes=2": r"gait\.shoes = 2: unknown key; known here: .*steps",
    "check --set shoes=2": r"shoes = 2: unknown key; known here: correction, gait",
    "check --set gait.step_length_m=.nan": r"step_length_m = nan: must be a finite",
    "check --set gait.step_period_s=-1": r"step_period_s = -1\.0: must be above 0\.0 s",
    "check --set correction.knot_spacing_s=0.1": (
        r"knot_spacing_s = 0\.1: must be between 0\.2 and 2\.0 s"
    ),
    "check --set learner.action.alternatives=1": (
        r"alternatives = 1: must be between 2 and 1001"
    ),
    "check --set gait.step_length_m=0.45": (
        r"cannot walk this gait: .*right leg are 0\.48\d* m apart, .* spans only .* m"
    ),
    "check --set gait.double_support_s=2": r"must be below step_period_s = 1\.875 s",
    "check --set learner.schedule.first_target_s=1.0e-7": (
        r"first_target_s = 1e-07: must be at least"
    ),
    "check --set gait.steps": r"must have the form section\.key=value",
    "check --config none.yaml": r"none\.yaml'.*cannot be read",
    "walk --static --tds -0.1": r"double_support_s = -0\.1: must be between 0\.1 and 5",
    "walk --static --tds nan": r"double_support_s = nan: must be a finite number",
    "walk --static --figure none/zmp.png": r"none/zmp.png: must be a file in a folder",
    "walk --static --figure out": r"out: ",
    "walk --memory none.npz": r"none\.npz: no such file",
    "walk --memory a_file": r"a_file: not a biped checkpoint",
    "walk --memory .": r"\.: not a biped checkpoint.*directory",
    "walk --memory out/memory.npz --preset paper": r"--preset paper: .* its own",
    "walk --memory out/memory.npz --set learner.action.limit_m=0.01": (
        r"limit_m = 0\.01: must stay 0\.024, as the memory has it: its actions are made"
    ),
    "walk --memory out/memory.npz --tds 1.3": r"double_support_s = 1\.3: must stay",
    "walk --memory out/memory.npz --set gait.shoes=2": r"gait\.shoes = 2: unknown key",
    "walk --static --tds 1.3 --set gait.double_support_s=1.2": (
        r"gives gait\.double_support_s a second time"
    ),
    'check --set gait.steps=2 --set gait={"steps":2}': r"gives gait\.steps a second",
    "view none": r"none: no such file or folder",
    "view --port 99999": r"99999: must be at most 65535",
    "view --domain 500": r"--domain, ROS_DOMAIN_ID: must be from 0 to 232",
    "demo --out a_file": r"a_file: must be a folder that can be written to",
    "up --foxglove 99999": r"99999: must be at most 65535",
    "learn --out a_file": r"a_file: must be a folder that can be written to",
    "learn --out a_file/out": r"a_file/out: must be a folder that can be written to",
    "learn --resume none.npz": r"none\.npz: no such file",
    "learn --resume a_file": r"a_file: not a biped checkpoint",
    "learn --resume out/memory.npz --seed 0": r"--seed 0: a memory brings its own seed",
    "learn --resume out/memory.npz --preset quick": r"--preset quick: .* its own",
    "learn --resume out/memory.npz --set gait.steps=2": r"gait\.steps = 2: must stay 1",
    "learn --resume out/memory.npz --config a.yaml": r"a\.yaml'.*cannot be read",
    "learn --resume out/memory.npz --fresh": r"--fresh: learns anew",
    "up --resume --out out --set gait.steps=2": r"gait\.steps = 2: must stay 1",
    "up --greedy --out out --set gait.steps=2": r"gait\.steps = 2: must stay 1",
    "up --greedy --out out --preset quick": r"--preset quick: .* its own settings",
    "up --resume --out out --seed 1": r"--seed 1: a memory brings its own seed",
    "up --resume --fresh --out out": r"--fresh: cannot be given with --greedy or --res",
    "learn --resume out/memory.npz --out a_file": r"a_file: must be a folder",
}
# argparse answers these itself.
NOT_UNDERSTOOD = {
    "": r"required: VERB",
    "run": r"invalid choice: 'run'",
    "learn --seed -1": r"--seed: -1: must be at least 0",
    "learn --seed one": r"--seed: invalid natural value: 'one'",
    "learn --episodes -1": r"--episodes: -1: must be at least 1",
    "learn --episodes 0": r"--episodes: 0: must be at least 1",
    "learn --seed 1 --seed 1": r"--seed: given twice",
    "learn --checkpoint-every -1": r"--checkpoint-every: -1: must be at least 0",
    "learn --checkpoint-every nan": r"--checkpoint-every: nan: must be at least 0",
    "up --episodes 0": r"--episodes: 0: must be at least 1",
    "up --out a --out=b": r"--out: given twice",
    "bag info a_file b_file": r"unrecognized arguments: b_file",
    "learn --replay-mb -1": r"--replay-mb: -1: must be at least 0",
    "learn --no-replay --replay-mb 9": r"not allowed with argument --no-replay",
    "learn --preset fast": r"--preset: invalid choice: 'fast' .*paper.*coarse.*quick",
    "learn --checkpoint-every soon": r"invalid duration_s value: 'soon'",
    "walk": r"one of the arguments --memory --static is required",
    "walk --static --memory out/memory.npz": r"not allowed with argument --static",
    "walk --static --seed -1": r"--seed: -1: must be at least 0",
    "walk --static --tds short": r"invalid float value: 'short'",
    "check --tds 1.0": r"unrecognized arguments: --tds 1\.0",
}
# Values that the YAML reader or Python itself stumbles over.
STUMBLING_BLOCKS = {
    "an integer beyond all floats": "gait.step_length_m=1" + 400 * "0",
    "an integer beyond all conversion": "gait.steps=1" + 5000 * "0",
    "a day that there is not": "gait.steps=2001-99-99",
}


@pytest.fixture(scope="module")
def memory(tmp_path_factory) -> bytes:
    """A memory of nothing yet."""
    file = tmp_path_factory.mktemp("memory") / "memory.npz"
    run = TrainingRun(quick(*SHORT), seed=0)
    run.save(file)
    run.close()
    return file.read_bytes()


@pytest.fixture
def files(biped, tmp_path, memory) -> None:
    """What the command lines above name."""
    (tmp_path / "a_file").write_text("no folder\n")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "memory.npz").write_bytes(memory)


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize("line", REFUSED)
def test_it_is_refused_in_one_line(biped, line):
    outcome = biped(*line.split())
    assert (outcome.status, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert outcome.err.startswith(f"biped {line.split()[0]}: ")
    assert re.search(REFUSED[line], outcome.err)


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize("line", NOT_UNDERSTOOD)
def test_it_is_not_understood(biped, line):
    outcome = biped(*line.split())
    assert (outcome.status, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert re.match(rf"biped[\w ]*: .*{NOT_UNDERSTOOD[line]}.* --help\)", outcome.err)


@pytest.mark.parametrize("what", STUMBLING_BLOCKS)
def test_a_value_that_cannot_even_be_read_is_refused_in_one_line(biped, what):
    outcome = biped("check", "--set", STUMBLING_BLOCKS[what])
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize("line", [*REFUSED, *NOT_UNDERSTOOD])
def test_what_is_refused_leaves_files_and_folders_as_they_were(
    biped, line, tmp_path, memory
):
    biped(*line.split())
    assert {file.name for file in tmp_path.rglob("*")} == {
        "a_file",
        "out",
        "memory.npz",
    }
    assert (tmp_path / "out" / "memory.npz").read_bytes() == memory


def test_of_a_folder_that_cannot_be_made_nothing_is_left(biped, tmp_path):
    outcome = biped("learn", "--out", f"new/folder/{'x' * 300}")
    assert (outcome.status, list(tmp_path.iterdir())) == (2, [])


def test_a_process_says_it_with_its_exit_status(biped_process):
    outcome = biped_process("learn", "--set", "gait.shoes=2")
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1


def test_a_gait_that_cannot_be_walked_is_not_learned(biped, tmp_path):
    outcome = biped("learn", "--set", "gait.step_length_m=0.45", "--out", "out")
    assert (outcome.status, outcome.out) == (2, "")
    assert not (tmp_path / "out").exists()
