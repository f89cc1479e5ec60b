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
    entry_points={
        "console_scripts": ["view = biped_view.live.node:main"],
        "biped.verbs": ["view = biped_view.verbs.view:add_parser"],
    },
)
