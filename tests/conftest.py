"""The command line as its user meets it, and training runs that are closed again."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, sync_playwright
from tests.biped_bringup.runs import UninterruptedRun

from biped_bringup.cli.main import main
from biped_bringup.run_settings import RunSettings
from biped_bringup.training import TrainingRun

CHROMIUM = Path("/usr/bin/chromium")
FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
COMMAND = (sys.executable, "-m", "biped_bringup.cli.main")


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    out: str
    err: str

    @property
    def values(self) -> dict[str, Any]:
        """The JSON object that is all of standard output."""
        return json.loads(self.out)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    """Return a headless Chromium, Debian's.

    Of a module, not of a session: as long as it is there, playwright's event loop is
    the thread's, and what else would run one cannot.
    """
    if not CHROMIUM.exists():
        pytest.skip(f"no {CHROMIUM}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=str(CHROMIUM), args=list(FLAGS)
        )
        yield browser
        browser.close()


@pytest.fixture
def biped(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> Callable[..., Outcome]:
    """Run `biped` in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: object) -> Outcome:
        capfd.readouterr()
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as end:
            status = int(end.code or 0)
        return Outcome(status, *capfd.readouterr())

    return run


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start `biped` as a process of its own, in an empty folder."""
    started: list[subprocess.Popen[str]] = []

    def launch(*arguments: object) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [*COMMAND, *map(str, arguments)],
            cwd=tmp_path,
            env=os.environ | {"COLUMNS": "200"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield launch
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def biped_process(
    launch: Callable[..., subprocess.Popen[str]],
) -> Callable[..., Outcome]:
    """Run `biped` to its end as a process of its own."""

    def run(*arguments: object) -> Outcome:
        process = launch(*arguments)
        out, err = process.communicate(timeout=600)
        return Outcome(process.returncode, out, err)

    return run


@pytest.fixture
def training() -> Iterator[Callable[..., TrainingRun]]:
    """Make training runs, or take them from a file."""
    runs: list[TrainingRun] = []

    def make(source: RunSettings | Path, seed: int = 0, **options: int) -> TrainingRun:
        loads = isinstance(source, Path)
        runs.append(
            TrainingRun.load(source) if loads else TrainingRun(source, seed, **options)
        )
        return runs[-1]

    yield make
    for run in runs:
        run.close()


@pytest.fixture(scope="module")
def uninterrupted() -> Iterator[Callable[..., UninterruptedRun]]:
    """Hand out one uninterrupted run per settings and seed."""
    runs: dict[tuple[RunSettings, int], UninterruptedRun] = {}

    def run_of(settings: RunSettings, seed: int = 0) -> UninterruptedRun:
        if (settings, seed) not in runs:
            runs[settings, seed] = UninterruptedRun(settings, seed)
        return runs[settings, seed]

    yield run_of
    for uninterrupted in runs.values():
        uninterrupted.run.close()
