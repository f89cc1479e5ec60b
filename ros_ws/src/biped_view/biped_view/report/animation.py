"""A walk as an animation, GIF or MP4: the robot, its soles, ZMP and limit on the floor.

Frames are drawn in real time: a second of the walk takes a second. The last one stays,
with the end cause in words.
"""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import chain, repeat
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib import font_manager
from numpy.typing import ArrayLike
from PIL import Image, ImageDraw, ImageFont

from biped_common.command_line import CommandError
from biped_common.timing import CONTROL_PERIOD_US, seconds
from biped_description.robot import Robot
from biped_view.phases import phases, shown_rows, standing_feet
from biped_view.report.end_sentence import end_sentence
from biped_view.report.offscreen import Camera, OffscreenRobot
from biped_view.theme import LIGHT, Colour
from biped_view.walk_record import LoadedWalk, WalkRecord
from msgs_json.end_cause import EndCause
from sim_node.markers import support_polygon

_SIZE_PX: Final = (480, 360)
_FINER: Final = 2
"""Drawn so much larger, then made smaller, for smooth edges."""
_HOLD_S: Final = 2.5
"""How long the last frame stays."""
_GIF_TICKS: Final = 35
"""Per frame, 70 ms: GIF counts whole hundredths of a second."""
_GIF_COLOURS: Final = 128
_SWATCH_PX: Final = 20
"""High is a colour that the palette must have, however little is drawn in it."""
_MP4_TICKS: Final = 20
_LETTERS_PER_LINE: Final = 62
_AWAY_LEGS, _LEAST_WAY_LEGS, _HEIGHT_ANGLE_DEG = 3.0, 0.8, 35.0
_ANGLES = np.linspace(0.0, 2 * np.pi, 60)
_CIRCLE = np.column_stack((np.cos(_ANGLES), np.sin(_ANGLES)))
_DOT_M: Final = 0.015
_GRID_M, _LINES = 0.1, 18
_PAPER: Final[Colour] = (244, 246, 248)
_GRID: Final[Colour] = (222, 226, 231)
_SOLE: Final[Colour] = (140, 144, 150)
_SUPPORT: Final[Colour] = (190, 220, 240)
_GOOD: Final[Colour] = (0, 114, 84)
_BAD: Final[Colour] = (160, 64, 0)

Writer = Callable[[LoadedWalk], bytes]


def animation_writer(path: Path) -> Writer:
    """Return what renders a walk into the format that a file name asks for.

    Raises:
        CommandError: another format, or the extra that it needs is not installed.
    """
    if path.suffix == ".gif":
        return render_gif
    if path.suffix == ".mp4":
        try:
            import av  # noqa: F401
        except ImportError:
            raise CommandError(
                f"--animation {path}: MP4 needs PyAV: pip install 'biped[video]'"
            ) from None
        return render_mp4
    raise CommandError(f"--animation {path}: must end in .gif or .mp4")


def render_gif(walk: LoadedWalk) -> bytes:
    """Return a GIF that repeats for ever."""
    drawn = list(_pictures(walk, _GIF_TICKS))
    # One palette for all, so that what stands still stays the same to the last bit.
    some = [np.asarray(drawn[k * (len(drawn) - 1) // 3]) for k in range(4)]
    marks = (LIGHT.zmp, LIGHT.zmp_reference, LIGHT.limit)
    swatches = [np.full((_SWATCH_PX, _SIZE_PX[0], 3), c, np.uint8) for c in marks]
    palette = Image.fromarray(np.vstack(some + swatches)).quantize(_GIF_COLOURS)
    pictures = [
        picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in drawn
    ]
    period_ms = _GIF_TICKS * CONTROL_PERIOD_US // 1000
    periods = [period_ms] * (len(pictures) - 1) + [round(1000 * _HOLD_S)]
    stream = io.BytesIO()
    pictures[0].save(
        stream, "GIF", save_all=True, append_images=pictures[1:], duration=periods,
        loop=0, optimize=True, disposal=1,
    )  # fmt: skip
    return stream.getvalue()


def render_mp4(walk: LoadedWalk) -> bytes:
    """Return an MP4 in H.264, as all browsers play it."""
    import av

    per_second = Fraction(1_000_000, _MP4_TICKS * CONTROL_PERIOD_US)
    stream = io.BytesIO()
    with av.open(stream, "w", format="mp4") as file:
        video: Any = file.add_stream("h264", rate=per_second, options={"crf": "20"})
        video.width, video.height = _SIZE_PX
        video.pix_fmt = "yuv420p"
        pictures = list(_pictures(walk, _MP4_TICKS))
        held = repeat(pictures[-1], round(_HOLD_S * per_second))
        for picture in chain(pictures, held):
            frame = av.VideoFrame.from_ndarray(np.asarray(picture), format="rgb24")
            file.mux(video.encode(frame))
        file.mux(video.encode())
    return stream.getvalue()


def _pictures(walk: LoadedWalk, ticks_per_frame: int) -> Iterator[Image.Image]:
    """Yield the frames; the last one says how the walk ended.

    Raises:
        CommandError: pose, joints or ZMP were not recorded.
    """
    record = walk.record
    rows = shown_rows(record, ticks_per_frame)
    if not rows:
        raise CommandError("--animation: the torso's pose was not recorded")
    camera = _camera(record, rows)
    floor = _Floor(record, camera)
    writing = _Writing(walk)
    with OffscreenRobot(Robot(record.robot), camera) as robot:
        for row in rows:
            pixels, is_robot = robot.picture(
                record.torso_position_m[row],
                record.torso_quaternion[row],
                record.joint_position_rad[row],
            )
            picture = floor.picture(row)
            picture.paste(Image.fromarray(pixels), mask=Image.fromarray(is_robot))
            floor.mark_zmp(picture, row)
            writing.write_on(picture, row, ended=row == rows[-1])
            yield picture.resize(_SIZE_PX, Image.Resampling.LANCZOS)


def _camera(record: WalkRecord, rows: list[int]) -> Camera:
    """Return a camera that stands still and sees the whole way.

    Short walks are seen from as far as a whole one, so that they can be compared.
    """
    leg_m = record.robot.stretched_leg_length_m
    x_m = record.torso_position_m[rows, 0]
    way_m = max(float(np.ptp(x_m)), _LEAST_WAY_LEGS * leg_m)
    middle = float(x_m.min()) + way_m / 2
    away_m = _AWAY_LEGS * leg_m + way_m / 2
    return Camera(
        (middle + 0.55 * away_m, -away_m, leg_m + 0.6 * away_m),
        (middle - 0.1 * leg_m, 0.0, 0.72 * leg_m),  # room for words on the left
        _HEIGHT_ANGLE_DEG,
        (_SIZE_PX[0] * _FINER, _SIZE_PX[1] * _FINER),
    )


class _Floor:
    """Draws what lies on the floor; the robot is put on top of it."""

    def __init__(self, record: WalkRecord, camera: Camera) -> None:
        self._record, self._camera = record, camera
        self._footholds = [
            (phase.first, standing_feet(record, phase.first))
            for phase in phases(record)
        ]
        self._empty = Image.new("RGB", camera.size_px, _PAPER)
        draw = ImageDraw.Draw(self._empty)
        for k in range(-_LINES, _LINES + 1):
            at, end = k * _GRID_M, _LINES * _GRID_M
            self._line(draw, ((at, -end), (at, end)), _GRID, 1)
            self._line(draw, ((-end, at), (end, at)), _GRID, 1)

    def picture(self, row: int) -> Image.Image:
        """Return the floor at a row of the record."""
        record, picture = self._record, self._empty.copy()
        draw = ImageDraw.Draw(picture)
        polygon = support_polygon(record.robot, standing_feet(record, row))
        if polygon:
            draw.polygon(self._pixels(polygon), fill=_SUPPORT)
        stood = {foot for first, feet in self._footholds if first <= row
                 for foot in feet}  # fmt: skip
        for foot in sorted(stood):
            sole = support_polygon(record.robot, [foot])
            self._line(draw, (*sole, sole[0]), _SOLE, 1)
        for which, colour in (
            (record.zmp_reference_m, LIGHT.zmp_reference),
            (record.zmp_m, LIGHT.zmp),
        ):
            way = which[: row + 1]
            self._line(draw, way[np.isfinite(way).all(axis=1)], colour, 2)
        return picture

    def mark_zmp(self, picture: Image.Image, row: int) -> None:
        """Draw ZMP, reference and limit over all else: soles would hide them."""
        record, draw = self._record, ImageDraw.Draw(picture)
        reference, measured = record.zmp_reference_m[row], record.zmp_m[row]
        ring = reference + record.zmp_limit_m * _CIRCLE
        self._line(draw, ring, _PAPER, 6)
        self._line(draw, ring, LIGHT.limit, 3)
        for at, colour in ((reference, LIGHT.zmp_reference), (measured, LIGHT.zmp)):
            draw.polygon(self._pixels(at + 1.4 * _DOT_M * _CIRCLE), fill=_PAPER)
            draw.polygon(self._pixels(at + _DOT_M * _CIRCLE), fill=colour)

    def _line(
        self, draw: ImageDraw.ImageDraw, points_m: ArrayLike, colour: Colour, width: int
    ) -> None:
        pixels = self._pixels(points_m)
        if len(pixels) > 1:
            draw.line(pixels, fill=colour, width=_FINER * width, joint="curve")

    def _pixels(self, points_m: ArrayLike) -> list[tuple[float, float]]:
        """Return where (n, 2) points of the floor are seen."""
        flat = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
        seen = self._camera.project(np.column_stack((flat, np.zeros(len(flat)))))
        return [(float(x), float(y)) for x, y in seen]


class _Writing:
    """What is written over the picture: who walks, the time, the end."""

    def __init__(self, walk: LoadedWalk) -> None:
        self._walk = walk
        file = font_manager.findfont("DejaVu Sans")
        self._font = ImageFont.truetype(file, 13 * _FINER)
        bold = font_manager.findfont(font_manager.FontProperties(weight="bold"))
        self._bold = ImageFont.truetype(bold, 15 * _FINER)

    def write_on(self, picture: Image.Image, row: int, *, ended: bool) -> None:
        """Write on a frame; on the last one, how the walk ended."""
        record, draw = self._walk.record, ImageDraw.Draw(picture)
        width, height = picture.size
        left, top, line = 14 * _FINER, 10 * _FINER, 19 * _FINER
        draw.text((left, top), self._walk.title, fill=LIGHT.ink, font=self._bold)
        time_s = f"{seconds(row + 1):.1f} s"
        draw.text(
            (width - left, top), time_s, fill=LIGHT.ink, font=self._bold, anchor="ra"
        )
        error_mm = 1000 * float(np.linalg.norm(record.zmp_error_m[row]))
        draw.text(
            (left, top + 1.2 * line),
            f"ZMP error {error_mm:.0f} of {1000 * record.zmp_limit_m:g} mm",
            fill=LIGHT.zmp,
            font=self._font,
        )
        if not ended:
            return
        sentence = end_sentence(record, self._walk.settings)
        lines = textwrap.wrap(sentence, _LETTERS_PER_LINE)
        above = height - line * len(lines) - 2 * top
        colour = _GOOD if record.end_cause is EndCause.COMPLETED else _BAD
        draw.rectangle((0, above, width, height), fill=colour)
        draw.multiline_text(
            (width / 2, above + top), "\n".join(lines), fill=(255, 255, 255),
            font=self._font, anchor="ma", align="center",
            spacing=line - 13 * _FINER - 3 * _FINER,
        )  # fmt: skip
