from setuptools import find_packages, setup

NAME = "ros2_verbs"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    entry_points={
        "ros2.commands": [
            "bag = ros2_verbs.bag",
            "daemon = ros2_verbs.daemon",
            "doctor = ros2_verbs.doctor",
            "interface = ros2_verbs.interface",
            "node = ros2_verbs.node",
            "param = ros2_verbs.param",
            "run = ros2_verbs.run",
            "service = ros2_verbs.service",
            "topic = ros2_verbs.topic",
            "wtf = ros2_verbs.doctor",
        ],
        "ros2.bag_verbs": [
            "info = ros2_verbs.bag.info",
            "play = ros2_verbs.bag.play",
            "record = ros2_verbs.bag.record",
        ],
        "ros2.daemon_verbs": [
            "status = ros2_verbs.daemon.status",
        ],
        "ros2.doctor_verbs": [
            "hello = ros2_verbs.doctor.hello",
        ],
        "ros2.interface_verbs": [
            "list = ros2_verbs.interface.list",
            "package = ros2_verbs.interface.package",
            "packages = ros2_verbs.interface.packages",
            "proto = ros2_verbs.interface.proto",
            "show = ros2_verbs.interface.show",
        ],
        "ros2.node_verbs": [
            "info = ros2_verbs.node.info",
            "list = ros2_verbs.node.list",
        ],
        "ros2.param_verbs": [
            "delete = ros2_verbs.param.delete",
            "describe = ros2_verbs.param.describe",
            "dump = ros2_verbs.param.dump",
            "get = ros2_verbs.param.get",
            "list = ros2_verbs.param.list",
            "load = ros2_verbs.param.load",
            "set = ros2_verbs.param.set",
        ],
        "ros2.service_verbs": [
            "call = ros2_verbs.service.call",
            "echo = ros2_verbs.service.echo",
            "find = ros2_verbs.service.find",
            "info = ros2_verbs.service.info",
            "list = ros2_verbs.service.list",
            "type = ros2_verbs.service.type",
        ],
        "ros2.topic_verbs": [
            "bw = ros2_verbs.topic.bw",
            "delay = ros2_verbs.topic.delay",
            "echo = ros2_verbs.topic.echo",
            "find = ros2_verbs.topic.find",
            "hz = ros2_verbs.topic.hz",
            "info = ros2_verbs.topic.info",
            "list = ros2_verbs.topic.list",
            "pub = ros2_verbs.topic.pub",
            "type = ros2_verbs.topic.type",
        ],
        "ros2.wtf_verbs": [
            "hello = ros2_verbs.doctor.hello",
        ],
    },
)
