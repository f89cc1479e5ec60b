"""The files by which other tools know the project say what the project says."""

import re
import shutil
import subprocess
from datetime import date
from pathlib import Path
from typing import Any

import tomllib
import yaml

TOP = Path(__file__).resolve().parents[1]
PACKAGE_FILES = ("ros_ws/src/*/setup.py", "ros_ws/src/*/package.xml")
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]


def parsed(path: str) -> dict[str, Any]:
    """Return the YAML of a file."""
    return yaml.safe_load((TOP / path).read_text())


def commands_of(target: str) -> list[str]:
    """Return what make runs for a target, its prerequisites being up to date."""
    text = (TOP / "Makefile").read_text().replace("$(BIN)", ".venv/bin")
    recipe = re.search(rf"^{target}:.*\n((?:\t.+\n)+)", text, re.M)
    assert recipe is not None
    return [line.strip() for line in recipe[1].splitlines()]


# -- continuous integration ------------------------------------------------------------


def test_the_workflow_runs_what_ci_runs() -> None:
    steps = parsed(".github/workflows/ci.yml")["jobs"]["check"]["steps"]
    script = (TOP / ".ci" / "run").read_text().splitlines()
    assert [step["run"] for step in steps if "run" in step] == [
        line for line in script if line.startswith("make ")
    ]


def test_the_workflow_runs_on_the_python_of_the_makefile() -> None:
    steps = parsed(".github/workflows/ci.yml")["jobs"]["check"]["steps"]
    (version,) = (s["with"]["python-version"] for s in steps if "with" in s)
    assert f"no Python {version} found" in (TOP / "Makefile").read_text()


def test_the_workflow_runs_every_week() -> None:
    # YAML 1.1 reads the key `on` as true.
    (entry,) = parsed(".github/workflows/ci.yml")[True]["schedule"]
    assert re.fullmatch(r"\d+ \d+ \* \* [0-6]", entry["cron"])


def test_the_hooks_run_what_make_lint_runs() -> None:
    (local,) = parsed(".pre-commit-config.yaml")["repos"]
    assert local["repo"] == "local"
    assert [hook["entry"] for hook in local["hooks"]] == commands_of("lint")
    for hook in local["hooks"]:
        assert {"id", "name", "language", "pass_filenames"} <= hook.keys()


# -- version and citation --------------------------------------------------------------


def test_the_newest_release_in_the_changelog_is_this_version() -> None:
    text = (TOP / "CHANGELOG.md").read_text()
    version, day = re.findall(r"^## \[(\d[^]]*)\] - (\S+)$", text, re.M)[0]
    cited = parsed("CITATION.cff")
    assert (version, date.fromisoformat(day)) == (
        PROJECT["version"],
        cited["date-released"],
    )


def test_the_citation_has_what_the_format_asks_for() -> None:
    cited = parsed("CITATION.cff")
    assert cited["cff-version"] == "1.2.0"
    assert cited.keys() >= {"message", "title", "authors"}
    for work in [cited, *cited["references"]]:
        assert work["title"]
        assert all(author["name"] for author in work["authors"])


def test_the_citation_says_what_the_project_says() -> None:
    cited = parsed("CITATION.cff")
    assert (cited["version"], cited["license"], cited["authors"]) == (
        PROJECT["version"],
        PROJECT["license"],
        PROJECT["authors"],
    )


def test_make_version_changes_one_line_of_every_file(tmp_path: Path) -> None:
    files = [
        file.relative_to(TOP)
        for pattern in ("CITATION.cff", "pyproject.toml", *PACKAGE_FILES)
        for file in TOP.glob(pattern)
    ]
    for file in [Path("Makefile"), *files]:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(TOP / file, tmp_path / file)
    subprocess.run(["make", "-s", "version", "TO=9.8.7"], cwd=tmp_path, check=True)
    for file in files:
        before = (TOP / file).read_text().splitlines()
        after = (tmp_path / file).read_text().splitlines()
        (change,) = (
            pair for pair in zip(before, after, strict=True) if len({*pair}) > 1
        )
        assert change[1] == change[0].replace(PROJECT["version"], "9.8.7")
