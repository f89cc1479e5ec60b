"""Topics chosen by name, by pattern, by exclusion."""

import pytest

from biped_bag.recorder.selection import selection_of
from biped_bag.recorder.settings import RecorderSettings
from biped_common.settings import SettingsError


def wants(topic, **settings):
    """Return whether a topic is wanted with these settings."""
    return selection_of(RecorderSettings(**settings)).wants(topic)


def test_everything_is_recorded_unless_told_otherwise():
    assert wants("/clock")


def test_names_select():
    assert wants("/clock", topics="/biped/zmp clock")
    assert not wants("/rosout", topics="/biped/zmp clock")


def test_a_pattern_matches_whole_names():
    assert wants("/biped/zmp", regex="/biped/.*")
    assert not wants("/a/biped/zmp", regex="/biped/.*")


def test_names_and_pattern_add_up():
    assert wants("/clock", topics="/clock", regex="/biped/.*")
    assert wants("/biped/zmp", topics="/clock", regex="/biped/.*")


def test_an_exclusion_beats_both():
    assert not wants("/clock", topics="/clock", exclude_regex="/cl.*")


def test_hidden_topics_are_recorded_when_asked_for_or_named():
    assert not wants("/a/_feedback")
    assert wants("/a/_feedback", include_hidden=True)
    assert wants("/a/_feedback", topics="/a/_feedback")


def test_what_is_no_pattern_is_refused():
    with pytest.raises(SettingsError, match="regex = '\\['"):
        selection_of(RecorderSettings(regex="["))
