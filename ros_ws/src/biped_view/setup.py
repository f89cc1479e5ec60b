from setuptools import find_packages, setup

NAME = "biped_view"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    package_data={NAME: ["report/*.j2"]},
    entry_points={
        "biped.verbs": [
            "report = biped_view.verbs.report:add_parser",
            "view = biped_view.verbs.view:add_parser",
        ],
        "console_scripts": [
            "foxglove_bridge = biped_view.foxglove.bridge:main",
            "tf_node = biped_view.tf_node:main",
            "view = biped_view.live.node:main",
        ],
    },
)
