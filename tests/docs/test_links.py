"""Links of the pages lead somewhere."""

import re
from pathlib import Path

import pytest
from tests.docs.pages import PAGES, TOP, anchors, prose

LINKS = [
    (page, target)
    for page in PAGES
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page))
    if "://" not in target
]


@pytest.mark.parametrize(
    ("page", "target"), LINKS, ids=lambda value: str(value).removeprefix(f"{TOP}/")
)
def test_a_link_within_the_repository_leads_somewhere(page: Path, target: str) -> None:
    path, _, anchor = target.partition("#")
    file = (page.parent / path).resolve() if path else page
    assert file.exists()
    assert not anchor or anchor in anchors(file)
