"""The first replay that a page shows is of a walk, not of nodes that start."""

import shlex

import pytest
from tests.docs.pages import TOP, blocks

from biped_bag.storage.reader import BagReader
from biped_bringup.cli.main import parser
from msgs_json.topics import OBSERVATION


@pytest.mark.parametrize("page", ["docs/usage.md", "docs/bags.md"])
def test_the_first_replay_shows_a_walk(page: str) -> None:
    told = "\n".join(
        block.text
        for block in blocks((TOP / page).read_text())
        if block.language == "sh"
    )
    line = next(line for line in told.splitlines() if line.startswith("biped bag play"))
    words = shlex.split(line, comments=True)[1:]
    options = parser(words).parse_args(words)
    bag = BagReader(TOP / options.bag)
    since_ns = bag.start_ns + int(1e9 * float(options.start))
    until_ns = since_ns + int(1e9 * float(options.duration or 1000.0))
    shown = bag.messages([OBSERVATION.name], since_ns, until_ns)
    assert len(list(shown)) > 100
