"""The text of `ros2 node info`; its look at a real graph is tested in tests/graph."""

from tests.ros2_verbs.golden_texts import golden

from ros2_verbs.graph.names import NodeName
from ros2_verbs.node.info import report

PARAMETERS = "rcl_interfaces/srv"
TURTLE = [
    (
        "Subscribers",
        [
            ("/parameter_events", ["rcl_interfaces/msg/ParameterEvent"]),
            ("/turtle1/cmd_vel", ["geometry_msgs/msg/Twist"]),
        ],
    ),
    (
        "Publishers",
        [
            ("/parameter_events", ["rcl_interfaces/msg/ParameterEvent"]),
            ("/rosout", ["rcl_interfaces/msg/Log"]),
            ("/turtle1/color_sensor", ["turtlesim/msg/Color"]),
            ("/turtle1/pose", ["turtlesim/msg/Pose"]),
            ("/turtle1/rotate_absolute/_action/feedback", ["hidden"]),
        ],
    ),
    (
        "Service Servers",
        [
            ("/clear", ["std_srvs/srv/Empty"]),
            ("/kill", ["turtlesim/srv/Kill"]),
            ("/my_turtle/describe_parameters", [f"{PARAMETERS}/DescribeParameters"]),
            ("/my_turtle/get_parameter_types", [f"{PARAMETERS}/GetParameterTypes"]),
            ("/my_turtle/get_parameters", [f"{PARAMETERS}/GetParameters"]),
            ("/my_turtle/list_parameters", [f"{PARAMETERS}/ListParameters"]),
            ("/my_turtle/set_parameters", [f"{PARAMETERS}/SetParameters"]),
            (
                "/my_turtle/set_parameters_atomically",
                [f"{PARAMETERS}/SetParametersAtomically"],
            ),
            ("/reset", ["std_srvs/srv/Empty"]),
            ("/spawn", ["turtlesim/srv/Spawn"]),
            ("/turtle1/set_pen", ["turtlesim/srv/SetPen"]),
            ("/turtle1/teleport_absolute", ["turtlesim/srv/TeleportAbsolute"]),
            ("/turtle1/teleport_relative", ["turtlesim/srv/TeleportRelative"]),
        ],
    ),
    ("Service Clients", []),
    (
        "Action Servers",
        [("/turtle1/rotate_absolute", ["turtlesim/action/RotateAbsolute"])],
    ),
    ("Action Clients", []),
]


def test_the_report_is_that_of_the_tutorial():
    text = report(NodeName.parse("/my_turtle"), TURTLE, hidden=False)
    assert f"{text}\n" == golden("node_info")


def test_hidden_names_are_shown_when_asked_for():
    assert "_action/feedback: hidden" in report(
        NodeName.parse("/my_turtle"), TURTLE, hidden=True
    )


def test_two_types_of_one_name_stand_side_by_side():
    text = report(
        NodeName.parse("/a"), [("Publishers", [("/x", ["p/B", "p/C"])])], hidden=False
    )
    assert "    /x: p/B, p/C" in text


def test_a_name_without_slash_is_one_at_the_root():
    assert NodeName.parse("sim_node") == NodeName("/", "sim_node")
    assert NodeName.parse("sim_node").full == "/sim_node"


def test_a_name_is_split_at_its_last_slash():
    assert NodeName.parse("/left/arm") == NodeName("/left", "arm")
    assert NodeName.parse("/left/arm").full == "/left/arm"
