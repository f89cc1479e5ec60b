"""The Fast DDS profiles: what all of the project's participants have in common."""

import xml.etree.ElementTree as ElementTree

import pytest

from biped_ros.environment import LEASE_S, PROFILE_VARIABLE, node_environment


def texts(discovery_range, element):
    """Return the texts of an element and all that is in it, in their order."""
    environment = node_environment(3, discovery_range)
    root = ElementTree.parse(environment[PROFILE_VARIABLE]).getroot()
    (found,) = root.iter(f"{{http://www.eprosima.com}}{element}")
    return [f"{item.tag} {(item.text or '').strip()}" for item in found.iter()]


@pytest.mark.parametrize("element", ["discovery_config", "data_writer"])
def test_all_discover_and_repair_alike_wherever_they_look(element):
    assert texts("LOCALHOST", element) == texts("SUBNET", element)


def test_the_lease_is_as_the_nodes_expect_it():
    tag = "{http://www.eprosima.com}sec"
    assert texts("SUBNET", "leaseDuration")[1:] == [f"{tag} {LEASE_S:g}"]


def test_what_is_local_stays_on_the_loopback_interface():
    assert texts("LOCALHOST", "interfaceWhiteList")[1:] == [
        "{http://www.eprosima.com}address 127.0.0.1"
    ]
