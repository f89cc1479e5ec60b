"""YAML is read as plain values, or refused in one line before it takes the machine."""

import subprocess
import sys

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from biped_common.plain_yaml import YamlError, read_yaml, read_yaml_file, yaml_text

LEVELS = 9
ALIAS_BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, LEVELS)
)
# What is refused, and what the line must say.
REFUSED = {
    "an alias": ("a: &x 1\nb: *x", r"^line 2, column 4: \*x: aliases are not read$"),
    "an alias bomb": (ALIAS_BOMB, r"^line 2, .*aliases"),
    "a value within itself": ("a: &a [*a]", "aliases"),
    "a key twice": (
        "s:\n  a: 1\n  b: 2\n  a: 3",
        r"^line 4, column 3: the key a stands",
    ),
    "a key twice in a list": ("- {a: 1, a: 1}", "the key a stands twice"),
    "two keys of one value": ("1: a\n0x1: b", "^line 2, column 1: the key 0x1 stands"),
    "deep brackets": ("[" * 100_000, "^line 1, column 51: nested deeper than 50"),
    "deep dashes": ("- " * 100_000, "nested deeper than 50 levels"),
    "deep keys": ("? " * 100_000, "nested deeper than 50 levels"),
    "many values": ("[" + "1," * 200_000 + "]", "more than 100000 values"),
    "a long text": ("a" * 1_000_001, "longer than 1000000 characters"),
    "a long number": ("9" * 5000, "a number of 5000 characters"),
    "a number to the base 60": ("1" + ":1" * 400_000, "a number of 800001"),
    "an open bracket": ("a: [", "^line 2, column 1: did not find"),
    "a zero": ("\0", "control characters"),
    "two documents": ("--- a\n--- b", "another document"),
    "an object of Python": ("!!python/object:os.system {}", "^line 1, column 1: could"),
    "a date that is none": ("2026-13-45", "month"),
    "a tag that does not fit": ("!!timestamp x", "."),
    "a truth that is none": ("!!bool x", "."),
    "an empty number": ("!!int ''", "."),
    "a list as a key": ("? [1]\n: 2", "^line 1, column 3: found unhashable key"),
    "half a letter": ("a: \ud800", "surrogates"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_it_is_refused_in_one_line(what):
    text, reason = REFUSED[what]
    with pytest.raises(YamlError, match=reason) as refusal:
        read_yaml(text)
    assert len(str(refusal.value).splitlines()) == 1
    assert len(str(refusal.value)) < 300


plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**63) | st.text() | st.floats(),
    lambda values: st.lists(values) | st.dictionaries(st.text(), values),
    max_leaves=20,
)


@given(plain)
def test_plain_values_come_back(values):
    assert repr(read_yaml(yaml_text(values))) == repr(values)


@given(plain)
def test_they_are_read_as_any_reader_reads_them(values):
    text = yaml.safe_dump(values)
    if "*id" not in text:
        assert repr(read_yaml(text)) == repr(yaml.safe_load(text))


def test_equal_values_are_written_each_time():
    shared = [1, 2]
    assert "&" not in yaml_text({"a": shared, "b": shared})


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    file = tmp_path / "large.yaml"
    with file.open("wb") as stream:
        stream.truncate(2**40)
    with pytest.raises(YamlError, match="is larger than 1000000 bytes"):
        read_yaml_file(file)


def test_a_file_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "a.yaml").write_bytes(b"a: \xff")
    with pytest.raises(YamlError, match="is not UTF-8 at byte 3"):
        read_yaml_file(tmp_path / "a.yaml")


@pytest.mark.parametrize("text", ["[" + "1," * 90_000, "a" * 1_000_000, ALIAS_BOMB])
def test_reading_takes_less_than_256_mb(tmp_path, text):
    (tmp_path / "a.yaml").write_text(text)
    program = (
        "import pathlib, resource\n"
        "from biped_common.plain_yaml import YamlError, read_yaml_file\n"
        "resource.setrlimit(resource.RLIMIT_AS, (2**28, 2**28))\n"
        "try: read_yaml_file(pathlib.Path('a.yaml'))\n"
        "except YamlError: pass\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
