"""An undisturbed run of a small study, and contestants of somebody else's."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from .studies import WALKS, carried_out, what_came_of

ELSEWHERE = Path(__file__).parent / "elsewhere"


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a laboratory in which the small study was carried out."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert carried_out(folder, WALKS) == []
    return folder


@pytest.fixture
def is_the_same(undisturbed: Path) -> Callable[[Path], bool]:
    """Whether in another folder came of it what came of it there."""
    return lambda folder: what_came_of(folder) == what_came_of(undisturbed)


@pytest.fixture
def lab(tmp_path: Path, undisturbed: Path) -> Path:
    """A folder of one's own with the study as it was carried out."""
    return shutil.copytree(undisturbed, tmp_path / "lab")


@pytest.fixture
def odd_contestants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a package of somebody else's with contestants."""
    metadata = tmp_path / "odd-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: odd\n")
    (metadata / "entry_points.txt").write_text(
        "[biped.contestants]\nodd = odd_contestants:ODD\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.syspath_prepend(ELSEWHERE)
