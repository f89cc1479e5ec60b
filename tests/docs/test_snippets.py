"""The snippets of docs/extend.md do what they say, as a reader would try them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.docs.pages import TOP, Block, blocks, sections

SECTIONS = sections(TOP / "docs" / "extend.md")
_FILE_NAME = re.compile(r"# ([\w./]+\.\w+)\n")
# What the page installs goes into a folder of its own, not into this environment.
INSTALLED = "installed"


def environment(folder: Path) -> dict[str, str]:
    """Return that of a shell in which the project is installed."""
    return os.environ | {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(folder / INSTALLED),
        "PIP_TARGET": str(folder / INSTALLED),
        "PIP_NO_INDEX": "1",
        "PIP_NO_BUILD_ISOLATION": "0",  # which is how pip spells that there be none
        "PIP_QUIET": "1",
    }


def run(block: Block, folder: Path) -> None:
    """Write a block into its file, or run it."""
    name = _FILE_NAME.match(block.text)
    if name is not None:
        file = folder / name[1]
        file.parent.mkdir(exist_ok=True)
        file.write_text(block.text.removeprefix(name[0]))
        return
    command = {
        "sh": ["bash", "-euo", "pipefail", "-c"],
        "python": [sys.executable, "-c"],
    }[block.language]
    done = subprocess.run(
        [*command, block.text],
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    assert done.returncode == 0, f"{block.text}\n{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("section", SECTIONS)
def test_the_snippets_of_a_section_run(section: str, tmp_path: Path) -> None:
    for block in blocks(SECTIONS[section]):
        if block.runs:
            run(block, tmp_path)
