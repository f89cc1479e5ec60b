"""Command lines: refused in one line, and no option given twice."""

import pytest

from biped_common.command_line import CommandParser, writable_folder


@pytest.fixture
def parser():
    """A parser with a verb, in the form of those of `biped`."""
    top = CommandParser(prog="biped")
    top.add_argument("--domain")
    verb = top.add_subparsers(required=True).add_parser("walk")
    verb.add_argument("bag")
    verb.add_argument("--set", dest="changes", action="append")
    verb.add_argument("--json", action="store_true")
    group = verb.add_mutually_exclusive_group()
    group.add_argument("--seed", type=int, default=0)
    group.add_argument("--tds")
    return top


@pytest.mark.parametrize(
    "line",
    [
        "walk a --seed 1 --seed 2",
        "walk a --seed 1 --seed 1",
        "walk a --seed=1 --see 2",
        "--domain 1 --domain 2 walk a",
        "walk a b",
        "walk a --seed one",
        "walk a --seed 1 --tds 1",
        "walk",
        "run",
        "",
    ],
)
def test_it_is_refused_in_one_line(parser, line, capsys):
    with pytest.raises(SystemExit) as end:
        parser.parse_args(line.split())
    assert end.value.code == 2
    (said,) = capsys.readouterr().err.splitlines()
    assert said.startswith("biped")


def test_an_option_that_collects_values_may_be_repeated(parser):
    words = ["walk", "a", "--set", "x=1", "--set", "y=2"]
    assert parser.parse_args(words).changes == ["x=1", "y=2"]


def test_a_flag_may_be_repeated(parser):
    assert parser.parse_args(["walk", "a", "--json", "--json"]).json


def test_a_parser_parses_one_command_line_after_the_other(parser):
    for seed in (1, 2):
        assert parser.parse_args(["walk", "a", "--seed", str(seed)]).seed == seed


def test_a_folder_that_is_there_stays_where_it_cannot_be_written_to(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match="must be a folder"):
        writable_folder(tmp_path / "file" / "out")
    assert [file.name for file in tmp_path.iterdir()] == ["file"]
