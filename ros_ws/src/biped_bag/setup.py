from setuptools import find_packages, setup

NAME = "biped_bag"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    entry_points={
        "console_scripts": [
            "recorder = biped_bag.recorder.node:main",
        ],
        "biped.verbs": [
            "bag = biped_bag.verbs.bag:add_parser",
        ],
        "biped.bag_verbs": [
            "cut = biped_bag.verbs.cut:add_parser",
            "export = biped_bag.verbs.export:add_parser",
            "info = biped_bag.verbs.info:add_parser",
            "play = biped_bag.verbs.play:add_parser",
            "recover = biped_bag.verbs.recover:add_parser",
            "verify = biped_bag.verbs.verify:add_parser",
        ],
    },
)
