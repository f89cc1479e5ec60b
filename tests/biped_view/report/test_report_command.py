"""`biped report`: files that open anywhere, and one line for what cannot be shown."""

import io
from dataclasses import fields, replace
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from biped_view.report.animation import render_gif, render_mp4
from biped_view.report.write import write_report
from biped_view.walk_sources import read_walk

_PATIENCE_MS = 120_000
_TICKS = 420
_FIGURES = {"from_above", "zmp_error", "waist", "joints", "t_err", "states",
            "learning_curve"}  # fmt: skip


@pytest.fixture(scope="module")
def written(walked_twice, tmp_path_factory):
    """The page and the figures of a memory."""
    folder = tmp_path_factory.mktemp("written")
    write_report(read_walk(walked_twice.memory), folder / "report.html", folder)
    return folder


def test_the_page_opens_offline_without_a_request_or_an_error(written, chromium):
    page_address = (written / "report.html").as_uri()
    requests, errors, told = [], [], []
    context = chromium.new_context(offline=True, viewport={"width": 320, "height": 240})
    page = context.new_page()
    page.set_default_timeout(_PATIENCE_MS)
    page.on("request", lambda request: requests.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on(
        "console",
        lambda message: (errors if message.type == "error" else told).append(
            message.text
        ),
    )
    page.goto(page_address)
    in_3d = page.frame_locator("#replay iframe")
    in_3d.locator("canvas").first.wait_for(state="attached")
    in_3d.locator("button").first.wait_for()  # of the player's timeline
    shown = {each.get_attribute("id") for each in page.locator("figure").all()}
    drawings = page.locator("figure svg").count()
    context.close()
    remote = [url for url in requests if not url.startswith(("data:", "blob:"))]
    assert remote == [page_address]
    assert errors == []
    assert shown == _FIGURES | {"replay"}
    assert drawings == len(_FIGURES)
    assert any("Embedded data loaded" in text for text in told)


def test_the_page_names_no_address(written):
    text = (written / "report.html").read_text()
    page = text.partition('<script type="application/json"')[0]
    page += text.rpartition("</script>")[2]
    # Namespaces of SVG are names, not addresses.
    assert "http" not in page.replace("http://www.w3.org/", "")


def test_every_figure_is_there_as_png_and_svg(written):
    assert {file.stem for file in written.glob("*.svg")} == _FIGURES
    for name in _FIGURES:
        with Image.open(written / f"{name}.png") as picture:
            assert picture.width > 1000


@pytest.fixture(scope="module")
def begun_walk(static_walk):
    """The first 0.84 s of the static walk."""
    record = static_walk.record
    rows = {
        field.name: getattr(record, field.name)[:_TICKS]
        for field in fields(record)
        if isinstance(getattr(record, field.name), np.ndarray)
    }
    return replace(static_walk, record=replace(record, **rows))


def test_the_gif_is_as_long_as_the_walk_and_stays_at_its_end(begun_walk):
    with Image.open(io.BytesIO(render_gif(begun_walk))) as gif:
        durations_ms = []
        for frame in range(gif.n_frames):
            gif.seek(frame)
            durations_ms.append(gif.info["duration"])
        assert gif.size == (480, 360)
    *walked, held = durations_ms
    assert sum(walked) == pytest.approx(2 * _TICKS, abs=70)
    assert held == 2500


def test_the_mp4_has_25_frames_a_second_in_h264(begun_walk):
    with av.open(io.BytesIO(render_mp4(begun_walk))) as file:
        (stream,) = file.streams.video
        assert stream.codec_context.name == "h264"
        assert stream.average_rate == 25
        frames = sum(1 for _ in file.decode(stream))
    assert frames == 22 + 62  # 0.84 s of walk, 2.5 s of its end


def test_the_command_says_what_it_wrote(biped, walked_twice):
    written = biped("report", walked_twice.bag, "--out", "walk.html")
    assert (written.status, written.err) == (0, "")
    assert written.out == "report     walk.html\n"
    text = Path("walk.html").read_text()
    assert "The ZMP left its 65 mm limit" in text
    assert "interpolated in between" in text


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "give either a bag, run or memory, or --static"),
        (["bag", "--static"], "give either a bag, run or memory, or --static"),
        (["nowhere"], "nowhere: no such file or folder"),
        (["bag", "--set", "gait.steps=2"], "--set: only for --static"),
        (["--static", "--walk", "1"], "--walk 1: only of a bag"),
        (["--static", "--out", "page.txt"], "--out page.txt: must end in .html"),
        (["--static", "--out", "no/page.html"], "must be a file in a folder that"),
        (["--static", "--animation", "a.webm"], "must end in .gif or .mp4"),
        (["--static", "--set", "gait.shoes=2"], "gait.shoes = 2: unknown key"),
    ],
)
def test_what_cannot_be_shown_is_refused_in_one_line(biped, arguments, reason):
    refused = biped("report", *arguments)
    assert refused.status == 2
    assert refused.out == ""
    assert reason in refused.err
    assert refused.err.count("\n") == 1
