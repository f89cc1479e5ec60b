"""What others wrote reaches a terminal as text, and as nothing else."""

import sys
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from biped_common.terminal_text import printable, printable_output

BIDI = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"


@given(st.text())
def test_no_control_character_is_left(text):
    shown = printable(text)
    assert not {unicodedata.category(c) for c in shown} & {"Cc", "Cs", "Zl", "Zp"}
    assert not set(shown) & set(BIDI)


@given(st.text())
def test_what_is_printable_stays_as_it_is(text):
    shown = printable(text)
    assert printable(shown) == shown


@given(st.text(st.characters(codec="utf-8", categories=("L", "M", "N", "P", "S"))))
def test_letters_of_all_scripts_stay(text):
    assert printable(text) == text


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("\x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("\x9b2J", r"\x9b2J"),
        ("a\u202eb", r"a\u202eb"),
        ("\x7f", r"\x7f"),
        ("\udcff", r"\udcff"),
        ("two\nlines\r", r"two\nlines\r"),
        ("Läufer 歩行 🚶 \\x1b", "Läufer 歩行 🚶 \\x1b"),
    ],
)
def test_escapes_are_those_of_python(text, shown):
    assert printable(text) == shown


def test_lines_of_our_own_stay_lines():
    assert printable("a\tb\nc\r\x1b", layout=True) == "a\tb\nc\\r\\x1b"


def test_what_is_printed_is_escaped_on_both_streams(capfd):
    with printable_output():
        print("a\x1b[2J")
        print("b\x9b", file=sys.stderr)
    assert capfd.readouterr() == ("a\\x1b[2J\n", "b\\x9b\n")


def test_afterwards_streams_are_as_before(capfd):
    before = sys.stdout, sys.stderr
    with pytest.raises(KeyError), printable_output():
        raise KeyError
    assert (sys.stdout, sys.stderr) == before
