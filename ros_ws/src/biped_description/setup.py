from setuptools import find_packages, setup

NAME = "biped_description"

setup(
    name=NAME,
    version="0.1.0",
    description="The biped: dimensions, URDF and kinematics",
    license="Apache-2.0",
    maintainer="The biped project authors",
    maintainer_email="maintainers@example.org",
    packages=find_packages(exclude=["test"]),
    package_data={NAME: ["py.typed", "*.urdf", "*/*.urdf", "*.yaml", "*/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
)
