"""The pages of the project: fenced blocks, what stands between them, headings."""

import re
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]
PAGES = sorted([*TOP.glob("*.md"), *TOP.glob("docs/*.md"), *TOP.glob("bags/*.md")])

_FENCED = re.compile(
    r"^(?P<not_run><!-- not run: .+ -->\n)?```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.M | re.S,
)


class Block(NamedTuple):
    """A fenced block."""

    language: str
    text: str
    runs: bool
    """Not marked as one that is not run."""


def blocks(text: str) -> list[Block]:
    """Return the fenced blocks of a page or a part of it."""
    return [
        Block(found["language"], found["text"], not found["not_run"])
        for found in _FENCED.finditer(text)
    ]


def prose(page: Path) -> str:
    """Return a page without its fenced blocks."""
    return _FENCED.sub("", page.read_text())


def sections(page: Path) -> dict[str, str]:
    """Return the text below each heading of the second level."""
    parts = re.split(r"^## (.+)\n", page.read_text(), flags=re.M)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def anchors(page: Path) -> set[str]:
    """Return what a link can point to in a page, as GitHub names its headings."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.M)
    return {
        re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-")
        for heading in headings
    }
