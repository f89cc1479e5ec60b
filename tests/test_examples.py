"""Every example does what it says."""

import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
EXAMPLES = {"cartpole.py": "learned after "}


def test_every_example_is_run_here() -> None:
    assert {file.name for file in (TOP / "examples").glob("*.py")} == set(EXAMPLES)


@pytest.mark.parametrize(("name", "said"), EXAMPLES.items())
def test_an_example_does_what_it_says(name: str, said: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, TOP / "examples" / name],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert said in done.stdout
    assert "not learned" not in done.stdout
