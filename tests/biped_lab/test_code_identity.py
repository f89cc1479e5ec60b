"""The identity of code changes when a walk could, and only then."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = '''"""A module."""

import ast
import numpy as np
from biped_common import timing
from biped_lab.other import f


def g(x: float) -> float:
    """Return more."""
    return f(x) + 1.0  # one more
'''
OTHER = "def f(x):\n    return 2 * x\n"
ASK = (
    "import sys; sys.path.insert(0, sys.argv[1]); import biped_lab; "
    "biped_lab.__path__.insert(0, sys.argv[1] + '/biped_lab'); "
    "from biped_lab.code_identity import code_identity; "
    "print(code_identity('biped_lab.mine'))"
)


def identity(folder: Path, source: str = SOURCE, other: str = OTHER) -> str:
    """Return what is said of a module `biped_lab.mine` with this source."""
    package = folder / "biped_lab"
    package.mkdir(exist_ok=True)
    (package / "mine.py").write_text(source)
    (package / "other.py").write_text(other)
    done = subprocess.run(
        [sys.executable, "-c", ASK, str(folder)],
        capture_output=True, text=True, check=True, env=os.environ,
    )  # fmt: skip
    return done.stdout


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> str:
    return identity(tmp_path_factory.mktemp("before"))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"""A module."""', '"""Another text."""'),
        ('    """Return more."""\n', ""),
        ("  # one more", ""),
        ("f(x) + 1.0", "(f(x) +\n            1.0)"),
    ],
)
def test_words_and_layout_do_not_matter(
    tmp_path: Path, before: str, old: str, new: str
) -> None:
    assert old in SOURCE
    assert identity(tmp_path, SOURCE.replace(old, new)) == before


@pytest.mark.parametrize(
    ("source", "other"),
    [
        (SOURCE.replace("1.0", "2.0"), OTHER),
        (SOURCE, OTHER.replace("2 * x", "3 * x")),
        (SOURCE.replace("from biped_common import timing\n", ""), OTHER),
    ],
    ids=["the module", "what it imports", "an import"],
)
def test_what_is_computed_matters(
    tmp_path: Path, before: str, source: str, other: str
) -> None:
    assert identity(tmp_path, source, other) != before


def test_versions_of_other_packages_are_told(before: str) -> None:
    import numpy

    assert f"'numpy': '{numpy.__version__}'" in before
    assert "'python': '" in before
    assert "scipy" not in before  # not imported


def test_the_code_of_a_learner_from_elsewhere_counts(tmp_path: Path) -> None:
    ask = (
        "import sys; sys.path.insert(0, sys.argv[1]); "
        "from biped_lab.code_identity import code_identity; "
        "print(code_identity('biped_bringup.training', 'their_learner.agent'))"
    )
    package = tmp_path / "their_learner"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "agent.py").write_text("from their_learner import rule\n")
    said = []
    for gain in (1.0, 2.0):
        (package / "rule.py").write_text(f"GAIN = {gain}\n")
        done = subprocess.run(
            [sys.executable, "-B", "-c", ask, str(tmp_path)],
            capture_output=True, text=True, check=True, env=os.environ,
        )  # fmt: skip
        said.append(done.stdout)
    assert said[0] != said[1]
