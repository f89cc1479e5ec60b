from setuptools import find_packages, setup

NAME = "biped_bringup"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(),
    package_data={NAME: ["presets/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/hook", ["hook/wheels_prefix.sh"]),
    ],
    entry_points={
        "console_scripts": [
            "biped = biped_bringup.cli.main:main",
        ],
        "biped.verbs": [
            "check = biped_bringup.cli.check:add_parser",
            "demo = biped_bringup.cli.demo:add_parser",
            "learn = biped_bringup.cli.learn:add_parser",
            "up = biped_bringup.cli.up:add_parser",
            "walk = biped_bringup.cli.walk:add_parser",
        ],
    },
)
