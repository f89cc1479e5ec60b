from setuptools import find_packages, setup

NAME = "trajectory_node"

setup(
    name=NAME,
    version="0.1.0",
    description="Gait, static waist, reference ZMP and waist correction of the biped",
    license="Apache-2.0",
    maintainer="The biped project authors",
    maintainer_email="maintainers@example.org",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "*.yaml", "*/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
)
