"""What `biped up` can and cannot be told about recording."""

from biped_bag.storage.writer import BagWriter


def test_a_bag_is_not_recorded_over(biped, tmp_path):
    BagWriter(tmp_path / "bag").close()
    outcome = biped("up", "--out", tmp_path, "--record", tmp_path / "bag")
    assert outcome.status == 2
    assert "is a bag already" in outcome.err


def test_recording_needs_a_recorder(biped, tmp_path):
    outcome = biped(
        "up", "--out", tmp_path, "--nodes", "sim", "--record", tmp_path / "b"
    )
    assert outcome.status == 2
    assert "needs the recorder among --nodes" in outcome.err


def test_a_split_of_no_size_is_refused(biped, tmp_path):
    outcome = biped("up", "--out", tmp_path, "--record-split", "size=0")
    assert outcome.status == 2
    assert "must be size=MB or episodes=N" in outcome.err
