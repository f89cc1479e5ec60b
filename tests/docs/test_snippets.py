"""What the pages tell to type does what they say, as a reader would try it.

Every block for a shell and every program is run, section by section, but those that a
mark says are not, and why. Commands end with status 0, or with the one that their
comment begins with (`# 3: ...`); a walk may fail.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.conftest import Outcome
from tests.docs.pages import PAGES, TOP, blocks, sections

RUN = ("sh", "python")
PARTS = [
    (page, section)
    for page in PAGES
    for section, text in sections(page).items()
    if any(block.language in RUN and block.to_run for block in blocks(text))
]
_FILE_NAME = re.compile(r"# ([\w./]+\.\w+)\n")
_STATUS = re.compile(r"# (\d+): ")
_PLAIN = re.compile(r"biped [^|&;<>$*#]*(#.*)?")
# What a page installs goes into a folder of its own, not into this environment.
INSTALLED = "installed"
MAY_FAIL = "biped walk "


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A checkout as far as the pages need it, where everything may be written."""
    shutil.copytree(TOP / "bags/sample", tmp_path / "bags/sample")
    for name in ("docs", "examples", "ros_ws", "msgs_json"):
        (tmp_path / name).symlink_to(TOP / name)
    activate = tmp_path / ".venv/bin/activate"
    activate.parent.mkdir(parents=True)
    activate.touch()  # the environment of the tests is active already
    return tmp_path


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


def run_in_shell(text: str, folder: Path) -> Outcome:
    """Run a line as a process of its own."""
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text],
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def allowed_statuses(line: str) -> set[int]:
    """Return how a command may end."""
    said = _STATUS.search(line)
    may_fail = line.startswith(MAY_FAIL)
    return {int(said[1])} if said else {0, 1} if may_fail else {0}


@pytest.mark.parametrize(
    ("page", "section"),
    PARTS,
    ids=[f"{page.relative_to(TOP)}: {section}" for page, section in PARTS],
)
@pytest.mark.thorough
def test_what_a_section_shows_works(
    page: Path, section: str, folder: Path, biped: Callable[..., Outcome]
) -> None:
    text = sections(page)[section]
    for block in blocks(text):
        name = _FILE_NAME.match(block.text)
        if name is not None:
            file = folder / name[1]
            file.parent.mkdir(exist_ok=True)
            file.write_text(block.text.removeprefix(name[0]))
        elif block.language == "python" and block.to_run:
            exec(compile(block.text, str(page), "exec"), {"__name__": "page"})
        elif block.language == "sh":
            for line in block.to_run:
                # What the section installs is not seen in this process.
                plain = _PLAIN.fullmatch(line) and "pip install" not in text
                words = shlex.split(line, comments=True)[1:]
                ended = biped(*words) if plain else run_in_shell(line, folder)
                assert ended.status in allowed_statuses(line), (line, ended)
                assert "Traceback" not in ended.err, (line, ended)
