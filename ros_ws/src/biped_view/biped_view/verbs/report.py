"""`biped report`: a walk as one HTML page, with figures and an animation if asked for.

Exit status:
    0  written, however the walk ended
    2  there is no walk there, or something cannot be written
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bringup.cli.options import add_settings_options, settings_of
from biped_common.command_line import DONE, CommandError, positive, writable_folder
from biped_common.terminal_text import printable_output
from biped_view.walk_record import LoadedWalk

_PAGE_SUFFIX = ".html"
_PAGE_OF_RUN, _STATIC_PAGE = "report.html", Path("static_walk.html")


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "report",
        help="a walk as one page: 3D replay, figures, how it ended; animations",
        description="Write what there is to see of a walk as one HTML page that needs "
        "nothing else: a bag's recorded walk, the frozen greedy walk of a memory or of "
        "a run, or the static walk. Exit status 0 when it is written, however the walk "
        "ended; 2 when there is no walk, or it cannot be written.",
    )
    parser.add_argument(
        "source",
        type=Path,
        nargs="?",
        metavar="BAG|RUN|MEMORY",
        help="a bag (folder or MCAP file), the folder of a run, or a memory.npz",
    )
    parser.add_argument(
        "--static", action="store_true", help="the walk without any correction instead"
    )
    parser.add_argument(
        "--walk",
        type=positive,
        metavar="N",
        help="of a bag, 1 for its first (default: its last)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE.html",
        help="the page (default: report.html beside a memory, BAG.html beside a bag, "
        f"{_STATIC_PAGE} here); one that is there is replaced",
    )
    parser.add_argument(
        "--figures",
        type=Path,
        metavar="DIR",
        help="write each figure there, too, as SVG and PNG",
    )
    parser.add_argument(
        "--animation",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.gif|.mp4",
        help="render the walk off screen into this file, too; repeatable. MP4 needs "
        "the extra `video`",
    )
    add_settings_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the report; print what was written."""
    _check(options)
    # Loaded late: drawing takes a second to import.
    from biped_view.report.animation import animation_writer
    from biped_view.report.write import write, write_report

    writers = [(path, animation_writer(path)) for path in options.animation]
    page = options.out or _default_page(options)
    _check_writable(page)
    if options.figures is not None:
        writable_folder(options.figures)
    with printable_output():
        walk = _walk(options)
        write_report(walk, page, options.figures)
        print(f"report     {page}", flush=True)
        if options.figures is not None:
            print(f"figures    {options.figures}")
        for path, render in writers:
            write(path, render(walk))
            print(f"animation  {path}", flush=True)
    return DONE


def _check(options: argparse.Namespace) -> None:
    """Refuse what does not go together."""
    if options.static == (options.source is not None):
        raise CommandError("give either a bag, run or memory, or --static")
    if not options.static:
        given = [
            name
            for name, value in (
                ("--preset", options.preset),
                ("--config", options.config),
                ("--set", options.changes),
            )
            if value
        ]
        if given:
            raise CommandError(
                f"{given[0]}: only for --static; a walk that is there has its own "
                "settings"
            )
    elif options.walk is not None:
        raise CommandError(f"--walk {options.walk}: only of a bag")
    if options.out is not None and options.out.suffix != _PAGE_SUFFIX:
        raise CommandError(f"--out {options.out}: must end in {_PAGE_SUFFIX}")
    for path in options.animation:
        _check_writable(path)


def _default_page(options: argparse.Namespace) -> Path:
    if options.static:
        return _STATIC_PAGE
    from biped_view.walk_sources import is_bag

    source: Path = options.source
    if is_bag(source):
        name = source.stem if source.is_file() else source.resolve().name
        return source.parent / (name + _PAGE_SUFFIX)
    return (source if source.is_dir() else source.parent) / _PAGE_OF_RUN


def _check_writable(path: Path) -> None:
    """Refuse a file that could not be written, before anything is walked."""
    if path.is_dir() or not path.parent.is_dir():
        raise CommandError(f"{path}: must be a file in a folder that exists")


def _walk(options: argparse.Namespace) -> LoadedWalk:
    from biped_view.walk_sources import read_walk
    from biped_view.walked_here import walk_without_learner

    if options.static:
        return walk_without_learner(settings_of(options))
    return read_walk(options.source, options.walk)
