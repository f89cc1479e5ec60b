"""A build backend for a project without code, for the tests of the install."""

import zipfile
from pathlib import Path


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """Write a wheel that holds nothing but its metadata."""
    name = "toy-1-py3-none-any.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w") as file:
        file.writestr(
            "toy-1.dist-info/METADATA",
            "Metadata-Version: 2.1\nName: toy\nVersion: 1\n",
        )
        file.writestr(
            "toy-1.dist-info/WHEEL",
            "Wheel-Version: 1.0\nGenerator: t\nRoot-Is-Purelib: true\n"
            "Tag: py3-none-any\n",
        )
        file.writestr("toy-1.dist-info/RECORD", "")
    return name
