"""Topics chosen by name, type and pattern, and excluded."""

import pytest

from biped_bag.recorder.settings import RecorderSettings
from biped_common.settings import SettingsError

TYPES = {
    "/clock": "rosgraph_msgs/msg/Clock",
    "/biped/zmp": "geometry_msgs/msg/PointStamped",
    "/biped/zmp_reference": "geometry_msgs/msg/PointStamped",
}


def wants(topic, **settings):
    """Return whether a topic is wanted with these settings."""
    types = [TYPES.get(topic, "std_msgs/msg/String")]
    return RecorderSettings(**settings).selection().wants(topic, types)


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
        RecorderSettings(regex="[").selection()


def test_types_select():
    assert wants("/biped/zmp", topic_types="geometry_msgs/msg/PointStamped")
    assert not wants("/clock", topic_types="geometry_msgs/msg/PointStamped")


def test_names_and_types_add_up():
    types = "geometry_msgs/msg/PointStamped"
    assert wants("/clock", topics="/clock", topic_types=types)


def test_a_topic_can_be_excluded_by_name():
    assert not wants("/biped/zmp", exclude_topics="/clock biped/zmp")
    assert wants("/biped/zmp_reference", exclude_topics="/clock biped/zmp")
