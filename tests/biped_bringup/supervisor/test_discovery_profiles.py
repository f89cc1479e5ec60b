"""The Fast DDS profiles: all participants of the project discover each other alike."""

import xml.etree.ElementTree as ElementTree

from biped_bringup.bag.player_node import player_environment
from biped_bringup.supervisor.environment import PROFILE_VARIABLE, node_environment


def discovery(environment: dict[str, str]) -> list[str]:
    """Return the texts of the discovery settings, in their order."""
    root = ElementTree.parse(environment[PROFILE_VARIABLE]).getroot()
    (config,) = root.iter("{http://www.eprosima.com}discovery_config")
    return [f"{item.tag} {(item.text or '').strip()}" for item in config.iter()]


def test_the_player_discovers_as_all_others_do() -> None:
    player = discovery(player_environment(3, "LOCALHOST"))
    assert player == discovery(node_environment(3, "LOCALHOST"))
