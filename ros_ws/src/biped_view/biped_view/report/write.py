"""Write a walk's report: one HTML page that asks for nothing, and figures as files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jinja2

from biped_common.atomic_file import atomic_file
from biped_common.command_line import CommandError
from biped_lab.report.theme import inline_svg, png, svg, theme
from biped_view.report.end_sentence import end_sentence
from biped_view.report.facts import key_figures, provenance
from biped_view.report.figures import figures
from biped_view.report.replay import Replay, replay
from biped_view.walk_record import LoadedWalk


def write_report(walk: LoadedWalk, page: Path, figures_folder: Path | None) -> None:
    """Write the page, and each figure as SVG and PNG if a folder is given.

    Args:
        walk: that is shown.
        page: the HTML file; one that is there is replaced.
        figures_folder: is there.

    Raises:
        CommandError: something cannot be written.
    """
    shown: list[dict[str, str]] = []
    with theme():
        for name, title, caption, figure in figures(walk):
            drawn = svg(figure)
            if figures_folder is not None:
                write(figures_folder / f"{name}.svg", drawn)
                write(figures_folder / f"{name}.png", png(figure))
            drawing = inline_svg(drawn, name, title)
            shown.append(
                {"name": name, "title": title, "caption": caption, "drawing": drawing}
            )
    in_3d = replay(walk.record)
    content: dict[str, Any] = {
        "title": walk.title,
        "sentence": end_sentence(walk.record, walk.settings),
        "key_figures": key_figures(walk),
        "remarks": walk.remarks,
        "replay": None if in_3d is None else _as_script(in_3d),
        "figures": shown,
        "provenance": provenance(walk),
    }
    write(page, _template().render(content).encode())


def write(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all.

    Raises:
        CommandError: it cannot be written.
    """
    try:
        with atomic_file(path) as stream:
            stream.write(content)
    except OSError as error:
        raise CommandError(f"{path}: cannot be written: {error.strerror}") from None


def _as_script(in_3d: Replay) -> str:
    """Return the replay as JSON that may stand in a script element."""
    text = json.dumps(in_3d._asdict())
    return text.replace("</", "<\\/").replace("<!--", "\\u003c!--")


def _template() -> jinja2.Template:
    # Pages of walks look like those of studies.
    folders = [
        jinja2.PackageLoader(package, "")
        for package in (__package__, "biped_lab.report")
    ]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(folders),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    return environment.get_template("report.html.j2")
