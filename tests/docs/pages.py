"""The pages of the project: fenced blocks, what stands between them, headings."""

import re
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]
PAGES = sorted([*TOP.glob("*.md"), *TOP.glob("docs/**/*.md"), *TOP.glob("bags/*.md")])

# A mark says why the next block is not run, or which of its commands are not:
#   <!-- not run: needs a cluster -->
#   <!-- not run (biped learn, biped up): they take minutes -->
_FENCED = re.compile(
    r"^(?P<mark><!-- not run(?: \((?P<some>[^)\n]+)\))?: [^\n]+ -->\n)?"
    r"```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.M | re.S,
)


class Block(NamedTuple):
    """A fenced block."""

    language: str
    text: str
    not_run: tuple[str, ...] | None
    """With what the commands begin that are not run, by its mark; None: all of it."""

    @property
    def commands(self) -> list[str]:
        """What is to be typed, of a block for a shell, one line for each command."""
        lines = re.sub(r"\\\n\s*", "", self.text).splitlines()
        return [line for line in lines if line and not line.startswith("#")]

    @property
    def to_run(self) -> list[str]:
        """Those of the commands, or all of another block, that a test runs."""
        if self.not_run is None:
            return []
        parts = self.commands if self.language == "sh" else [self.text]
        return [part for part in parts if not part.startswith(self.not_run)]


def blocks(text: str) -> list[Block]:
    """Return the fenced blocks of a page or a part of it."""
    found = []
    for match in _FENCED.finditer(text):
        some = tuple((match["some"] or "").split(", ")) if match["some"] else ()
        not_run = None if match["mark"] and not some else some
        found.append(Block(match["language"], match["text"], not_run))
    return found


def prose(page: Path) -> str:
    """Return a page without its fenced blocks."""
    return _FENCED.sub("", page.read_text())


def sections(page: Path) -> dict[str, str]:
    """Return the text below each heading of the second level; "" is before them."""
    parts = re.split(r"^## (.+)\n", page.read_text(), flags=re.M)
    return dict(zip(["", *parts[1::2]], parts[0::2], strict=True))


def anchors(page: Path) -> set[str]:
    """Return what a link can point to in a page, as GitHub names its headings."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.M)
    return {
        re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-")
        for heading in headings
    }
