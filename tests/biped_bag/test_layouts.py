"""The layouts for viewers name nothing that a bag does not hold."""

import json
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

ROOT = Path(__file__).parents[2]
LAYOUTS = ROOT / "docs/layouts"
SAMPLE = ROOT / "bags/sample/sample_0.mcap"
SCRIPT_PREFIX = "/studio_script"

PLOTJUGGLER = ET.parse(LAYOUTS / "plotjuggler.xml").getroot()
FOXGLOVE = json.loads((LAYOUTS / "foxglove.json").read_text())
SCRIPTS = [node["sourceCode"] for node in FOXGLOVE["userNodes"].values()]


@cache
def first_messages():
    """Return the first message of every topic of the sample, decoded."""
    first = {}
    with SAMPLE.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            first.setdefault(channel.topic, message)
    return first


def value_at(topic, fields):
    """Follow fields, such as `points[0]`, into the first message of a topic."""
    value = first_messages()[topic]
    for field in fields:
        name, *places = re.findall(r"\w+", field)
        value = getattr(value, name)
        for place in places:
            value = value[int(place)]
    return value


def panels():
    """Return the panels that the arrangement shows."""

    def leaves(node):
        if isinstance(node, str):
            return [node]
        return [*leaves(node["first"]), *leaves(node["second"])]

    return leaves(FOXGLOVE["layout"])


def plotted():
    """Return the paths of all plots of Foxglove, but constants."""
    plots = [c for name, c in FOXGLOVE["configById"].items() if name.startswith("Plot")]
    paths = [path["value"] for plot in plots for path in plot["paths"]]
    return [path for path in paths if path.startswith("/")]


EQUATIONS = PLOTJUGGLER.findall("customMathEquations/snippet")
CURVES = [
    *(curve.attrib["name"] for curve in PLOTJUGGLER.iter("curve")),
    *(source.text for each in EQUATIONS for source in each.iter("linked_source")),
    *(s.text for each in EQUATIONS for s in each.findall("additional_sources/*")),
]
COMPUTED = {each.attrib["name"] for each in EQUATIONS}


@pytest.mark.parametrize("curve", sorted(set(CURVES) - COMPUTED))
def test_every_curve_of_plotjuggler_is_a_number_in_the_sample(curve):
    topic = max((t for t in first_messages() if curve.startswith(f"{t}/")), key=len)
    value = value_at(topic, curve.removeprefix(f"{topic}/").split("/"))
    assert isinstance(value, float)


def test_plotjuggler_s_transform_is_the_waist_s():
    assert value_at("/biped/waist_reference", ["joint_names"])[0] == "waist"


@pytest.mark.parametrize(
    "path", [path for path in plotted() if not path.startswith(SCRIPT_PREFIX)]
)
def test_every_plain_path_of_foxglove_is_a_number_in_the_sample(path):
    topic, *fields = path.split(".")
    assert isinstance(value_at(topic, fields), float)


@pytest.mark.parametrize(
    "path", [path for path in plotted() if path.startswith(SCRIPT_PREFIX)]
)
def test_every_scripted_path_of_foxglove_is_in_a_payload_of_the_sample(path):
    output, field = path.split(".")
    (script,) = (s for s in SCRIPTS if f'output = "{output}"' in s)
    topic = re.search(r'inputs = \["(.*)"\]', script)[1]
    payload = json.loads(first_messages()[topic].data)
    value = (payload | payload.get("figures", {}))[field]
    kind = re.search(rf"^  {field}: (\w+);$", script, flags=re.MULTILINE)[1]
    assert isinstance(value, {"number": int | float, "boolean": bool}[kind])


def test_every_panel_of_foxglove_is_shown_and_configured():
    assert sorted(panels()) == sorted(FOXGLOVE["configById"])


def test_what_foxglove_shows_without_plotting_is_in_the_sample():
    view = FOXGLOVE["configById"]["3D!walk"]
    named = {
        *view["topics"],
        view["layers"]["robot"]["topic"],
        FOXGLOVE["configById"]["RawMessages!episode"]["topicPath"],
    }
    assert named <= set(first_messages())
