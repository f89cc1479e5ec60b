"""The sample bag is sound, and a learner still answers as recorded in it."""

from pathlib import Path

import pytest

from biped_bag.storage.reader import BagReader
from biped_bag.verification.learner import recorded_session
from biped_bag.verification.report import Verdict
from biped_bag.verification.verify import verify
from biped_bag.verification.walks import WANTED
from biped_bringup.cli.main import main

SAMPLE = Path(__file__).parents[2] / "bags/sample"
LARGEST_BYTES = 3_000_000


def test_every_correction_of_the_sample_comes_out_again():
    bag = BagReader(SAMPLE)
    messages = ((m.topic, m.data) for m in bag.messages(WANTED))
    found = verify(recorded_session(bag), messages)
    assert found.verdict is Verdict.VERIFIED
    assert found.corrections == 563


def test_the_sample_is_small():
    assert sum(file.stat().st_size for file in SAMPLE.iterdir()) < LARGEST_BYTES


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--rate", "0"], "--rate 0: must be a number above 0"),
        (["--rate", "fast"], "--rate fast: must be a number above 0"),
        (["--start", "1e6"], " s, so playing cannot start at 1e+06 s"),
        (["--remap", "/biped/zmp"], "must have the form /topic:=/other"),
        (["--remap", "/nobody:=/x"], "/nobody: not in the bag"),
        (["--remap", "/biped/zmp:=1 2"], "/biped/zmp:=1 2:"),
        (["--topics", "/nobody"], "/nobody: not in the bag"),
    ],
)
def test_what_cannot_be_played_is_refused_in_one_line(capsys, arguments, named):
    status = main(["bag", "play", str(SAMPLE), "--domain", "77", *arguments])
    complaint = capsys.readouterr().err
    assert status == 2
    assert named in complaint
    assert complaint.count("\n") == 1
