"""`ros2 interface`: the installed types and their definitions."""

from pathlib import Path

import pytest
from tests.ros2_verbs.golden_texts import golden

from ros2_verbs.interface.show import code_of, nested_type
from ros2_verbs.main import main

PACKAGE = "ros2cli_test_interfaces"
DEFINITIONS = {
    "ShortVaried": """\
# A constant
bool BOOL_CONST=true # Comment - Nesting Level 1: 1 of 2

# Bool and array of bools
bool bool_value
bool[<=3] bool_values # Comment - Nesting Level 1: 2 of 2

# Trailing comment
""",
    "ShortVariedNested": """\
# A short, varied type
ShortVaried short_varied # Comment - Nesting Level 2: 1 of 1
# Trailing comment
""",
    "ShortVariedMultiNested": """\
# A short, varied, and nested type
ShortVariedNested short_varied_nested # Comment - Nesting Level 3: 1 of 1
# Trailing comment
""",
}


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a package with three messages where only it is found."""
    index = tmp_path / "share/ament_index/resource_index/rosidl_interfaces"
    index.mkdir(parents=True)
    (index / PACKAGE).write_text(
        "".join(f"msg/{name}.idl\nmsg/{name}.msg\n" for name in DEFINITIONS)
    )
    folder = tmp_path / "share" / PACKAGE / "msg"
    folder.mkdir(parents=True)
    for name, text in DEFINITIONS.items():
        (folder / f"{name}.msg").write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize(
    ("options", "text"),
    [
        ([], "interface_show"),
        (["--all-comments"], "interface_show_all_comments"),
        (["--no-comments"], "interface_show_no_comments"),
    ],
)
def test_comments_are_shown_as_asked(
    options: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["interface", "show", f"{PACKAGE}/msg/ShortVariedMultiNested", *options])
    assert capsys.readouterr().out == golden(text)


def test_a_twist_is_shown_as_in_the_tutorial(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["interface", "show", "geometry_msgs/msg/Twist"])
    assert capsys.readouterr().out == golden("interface_show_twist")


def test_a_package_lists_messages_or_services(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["interface", "package", "std_srvs"])
    assert capsys.readouterr().out.splitlines() == [
        "std_srvs/srv/Empty",
        "std_srvs/srv/SetBool",
        "std_srvs/srv/Trigger",
    ]
    main(["interface", "package", "-m", "std_srvs"])
    assert capsys.readouterr().out == ""


def test_all_kinds_are_listed_under_their_titles(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["interface", "list"])
    lines = capsys.readouterr().out.splitlines()
    titles = [line for line in lines if not line.startswith("    ")]
    assert titles == ["Messages:", "Services:", "Actions:"]
    assert "    std_msgs/msg/String" in lines
    assert "    std_srvs/srv/SetBool" in lines


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["package", "not_a_package"], "Unknown package 'not_a_package'"),
        (["show", "not_a_package/msg/Foo"], "Unknown package 'not_a_package'"),
        (
            ["show", "std_msgs/msg/Foo"],
            "Could not find the interface 'std_msgs/msg/Foo'",
        ),
        (["show", "Foo"], "Invalid name 'Foo'. Expected three parts separated by '/'"),
    ],
)
def test_unknown_names_are_one_line_and_status_1(
    words: list[str], error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["interface", *words]) == 1
    assert capsys.readouterr().err == f"{error}\n"


def test_a_hash_in_a_default_text_is_no_comment() -> None:
    assert code_of('string colour "#fff" # of the sky') == 'string colour "#fff"'


def test_numbers_and_texts_have_no_definition_of_their_own() -> None:
    for code in ("float64 x", "string<=5 name", "uint8[3] rgb", "---", ""):
        assert nested_type("std_msgs", code) is None


def test_the_definition_of_a_field_is_found_by_its_package() -> None:
    assert nested_type("geometry_msgs", "Point[] points") == "geometry_msgs/msg/Point"
    assert nested_type("x", "std_msgs/Header header") == "std_msgs/msg/Header"


def test_packages_are_listed_by_kind(capsys: pytest.CaptureFixture[str]) -> None:
    main(["interface", "packages"])
    everything = capsys.readouterr().out.splitlines()
    main(["interface", "packages", "-m"])
    with_messages = capsys.readouterr().out.splitlines()
    assert everything == sorted(everything)
    assert "std_srvs" in everything and "std_srvs" not in with_messages
    assert "std_msgs" in with_messages


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["std_srvs/srv/SetBool"], '"data: false\n"\n'),
        (["geometry_msgs/msg/Vector3", "--no-quotes"], "x: 0.0\ny: 0.0\nz: 0.0\n\n"),
    ],
)
def test_a_prototype_has_all_fields_with_their_defaults(
    words: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["interface", "proto", *words]) == 0
    assert capsys.readouterr().out == text
