"""What `ros2 doctor` finds wrong; its look at a real graph is tested in tests/graph."""

import fcntl
import socket

import pytest
from rclpy.qos import LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo
from tests.ros2_verbs.golden_texts import golden

from ros2_verbs.doctor import graph, host, installation
from ros2_verbs.doctor.area import Area, complaints, report, summary
from ros2_verbs.doctor.graph import Topic
from ros2_verbs.doctor.hello import Summary

# As the graph reports it: nothing is left to the system.
KNOWN = {"depth": 1, "liveliness": LivelinessPolicy.AUTOMATIC}
RELIABLE = QoSProfile(**KNOWN, reliability=ReliabilityPolicy.RELIABLE)
BEST_EFFORT = QoSProfile(**KNOWN, reliability=ReliabilityPolicy.BEST_EFFORT)
TEXT = ["std_msgs/msg/String"]


def end(node, qos=RELIABLE):
    """Return a publisher or a subscription of a node."""
    return TopicEndpointInfo(node_name=node, qos_profile=qos)


CHATTER = Topic("/chatter", TEXT, [end("talker")], [end("listener")])
DEAF = Topic("/my_chatter", TEXT, [end("mynode", BEST_EFFORT)], [end("mynode")])


def interface(folder, name, flags):
    """Make the files by which the kernel describes a network interface."""
    (folder / name).mkdir()
    (folder / name / "flags").write_text(f"{flags:#x}\n")
    (folder / name / "mtu").write_text("1500\n")


def test_the_summary_of_failed_checks_is_that_of_the_tutorial():
    areas = [Area(name, "") for name in ("network", "platform", "topic")]
    areas[0].errors.append("No loopback IP address is found.")
    assert summary(areas, include_warnings=False) == golden("doctor_failed")


def test_all_checks_pass_in_spite_of_warnings():
    areas = [Area("network", "", warnings=["a"]), Area("topic", "")]
    assert summary(areas, include_warnings=False) == "\nAll 2 checks passed\n"


def test_warnings_fail_when_they_are_to_count():
    areas = [Area("network", "", warnings=["a"]), Area("topic", "")]
    assert "1/2 checks failed" in summary(areas, include_warnings=True)


def test_errors_are_told_from_warnings():
    area = Area("network", "", errors=["b"], warnings=["a"])
    assert complaints([area]) == ["UserWarning: a", "UserWarning: ERROR: b"]


def test_the_report_of_qos_is_that_of_the_example():
    text = report(graph.qos_area([CHATTER, DEAF]))
    assert f"{text}\n" == golden("doctor_qos_report")


def test_ends_that_cannot_meet_are_an_error():
    assert graph.qos_area([CHATTER, DEAF]).errors == [
        "QoS compatibility error found on topic '/my_chatter': "
        "Best effort publisher and reliable subscription;"
    ]


def test_without_pairs_the_report_says_so():
    items = graph.qos_area([]).items
    assert items == [("compatibility status", "No publisher/subscriber pairs found")]


def test_a_topic_with_one_end_is_a_warning():
    ends = [end("a")]
    area = graph.topic_area([Topic("/x", TEXT, ends, []), Topic("/y", TEXT, [], ends)])
    assert area.warnings == [
        "Publisher without subscriber detected on /x.",
        "Subscriber without publisher detected on /y.",
    ]


def test_a_topic_of_two_types_is_an_error():
    ends = [end("a")]
    (error,) = graph.topic_area([Topic("/x", ["p/A", "p/B"], ends, ends)]).errors
    assert "/x has more than one type: p/A, p/B" in error


def test_two_learners_are_an_error():
    names = ["/learner_node", "/sim_node", "/learner_node"]
    (error,) = graph.node_area(names).errors
    assert "2 nodes share the name /learner_node" in error


def test_loopback_suffices_where_nobody_else_is_looked_for(tmp_path):
    interface(tmp_path, "lo", 0x9)
    area = host.network_area("LOCALHOST", tmp_path)
    assert not area.failed(include_warnings=True)


def test_in_a_subnet_multicast_is_missed(tmp_path):
    interface(tmp_path, "lo", 0x9)
    interface(tmp_path, "eth0", 0x3)
    assert host.network_area("SUBNET", tmp_path).warnings == [
        "No multicast IP address is found."
    ]


def test_an_interface_that_is_down_does_not_count(tmp_path):
    interface(tmp_path, "lo", 0x9)
    interface(tmp_path, "eth0", 0x1002)
    warnings = host.network_area("SUBNET", tmp_path).warnings
    assert "Only loopback IP address is found." in warnings


def test_a_machine_without_loopback_fails(tmp_path):
    interface(tmp_path, "eth0", 0x1003)
    area = host.network_area("LOCALHOST", tmp_path)
    assert area.errors == ["No loopback IP address is found."]


def test_leftovers_of_killed_processes_are_told_from_what_is_in_use(tmp_path):
    for name in ("fastrtps_dead", "fastrtps_live"):
        (tmp_path / name).write_bytes(bytes(1000))
        (tmp_path / f"{name}_el").touch()
    with (tmp_path / "fastrtps_live_el").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        area = host.shared_memory_area(tmp_path)
    assert dict(area.items) == {"files of Fast DDS": "4", "without an owner": "2"}
    assert "2 files of Fast DDS" in area.warnings[0]


@pytest.mark.parametrize("domain", ["-1", "233", "ten"])
def test_a_domain_that_cannot_be_is_an_error(domain):
    (error,) = installation.ros_area({"ROS_DOMAIN_ID": domain}).errors
    assert f"ROS_DOMAIN_ID is {domain}" in error


def test_a_domain_with_unsafe_ports_is_a_warning():
    area = installation.ros_area({"ROS_DOMAIN_ID": "150"})
    assert not area.errors and "Domain 150" in area.warnings[0]


def test_an_unknown_discovery_range_is_an_error():
    area = installation.ros_area({"ROS_AUTOMATIC_DISCOVERY_RANGE": "HERE"})
    assert "must be one of SUBNET, LOCALHOST, OFF" in area.errors[0]


def test_another_distribution_than_the_wheels_is_an_error():
    (error,) = installation.ros_area({"ROS_DISTRO": "humble"}).errors
    assert "ROS_DISTRO is humble, but the wheels are those of jazzy" in error


def test_another_middleware_than_asked_for_is_an_error():
    wanted = {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}
    (error,) = installation.middleware_area("rmw_fastrtps_cpp", wanted).errors
    assert "rmw_cyclonedds_cpp, but rmw_fastrtps_cpp runs" in error


def test_what_the_project_needs_is_installed():
    area = installation.package_area()
    assert not area.errors
    assert {"ros-jazzy-rclpy", "ros-fastrtps", "mcap"} <= dict(area.items).keys()


def test_greetings_of_others_are_counted_by_host() -> None:
    heard = Summary("/canyouhearme", 1.0)
    heard.published, heard.sent = 10, 9
    for host_name in ("atlas", "atlas", "babel"):
        heard.hear(heard.subscribed, f"hello, it's me {host_name}")
    heard.hear(heard.received, f"hello, it's me {socket.gethostname()}")
    assert f"{heard.text()}\n" == golden("doctor_hello")


def test_a_greeting_makes_no_lines_of_its_own() -> None:
    heard = Summary("/canyouhearme", 1.0)
    heard.hear(heard.subscribed, "hello,\n\x1b[2J")
    assert "hello,\\n\\x1b[2J  " in heard.text()
