"""What the recorder says at its end."""

from pathlib import Path

from biped_bag.recorder.counts import counts_table


def counts(received, written, lost):
    return {"received": received, "written": written, "lost": lost}


def test_a_recording_without_loss_is_told_in_one_line():
    table = counts_table({"/a": counts(3, 3, 0), "/b": counts(4, 4, 0)}, Path("bag"))
    assert table == ["bag: 7 messages written, 0 lost"]


def test_a_topic_that_lost_messages_is_named():
    table = counts_table({"/a": counts(3, 3, 0), "/b": counts(4, 3, 2)}, Path("bag"))
    assert table == [
        "/b: 4 received, 3 written, 2 lost",
        "bag: 6 messages written, 2 lost",
    ]
