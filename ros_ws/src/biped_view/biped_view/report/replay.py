"""The walk in three dimensions: a page of viser's own, to be turned and scrubbed.

The player and its recorded scenes are one text each, so that a page that holds them
asks for nothing else.
"""

from __future__ import annotations

import io
import re
from contextlib import redirect_stdout
from typing import Final, NamedTuple

import numpy as np
import viser

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.robot import Robot
from biped_view.floor_scene import FloorScene, sole_corners
from biped_view.phases import shown_rows, standing_feet
from biped_view.robot_scene import RobotScene
from biped_view.theme import DARK, LIGHT, Theme
from biped_view.walk_record import WalkRecord

TICKS_PER_FRAME: Final = 20
"""25 frames a second, as the torso's pose is recorded."""
_EYE_M, _HEIGHT_M = (0.85, -1.45, 0.75), 0.45
"""Of the camera, from the middle of the way, and what it looks at."""
_DATA = re.compile(r'window\.__VISER_EMBED_DATA__="([A-Za-z0-9+/=]*)"')


class Replay(NamedTuple):
    """A player, and the same walk in two looks."""

    player: str
    """HTML without a scene; `SCENE` and `DARK` stand where they are filled in."""
    light: str
    """Scene, as the player takes it."""
    dark: str


SCENE, DARK_MODE = "@SCENE@", "@DARK@"


def replay(record: WalkRecord) -> Replay | None:
    """Return the walk in 3D; None where pose or joints were not recorded."""
    frames = shown_rows(record, TICKS_PER_FRAME)
    if not frames:
        return None
    pages = [_page(record, frames, theme) for theme in (LIGHT, DARK)]
    scenes = []
    for page in pages:
        found = _DATA.search(page)
        assert found is not None
        scenes.append(found[1])
    player = (
        pages[0]
        .replace(scenes[0], SCENE)
        .replace("darkMode:false", f"darkMode:{DARK_MODE}")
    )
    return Replay(player, *scenes)


def _page(record: WalkRecord, frames: list[int], theme: Theme) -> str:
    # A scene is a server's; this one has no visitors, and what it says is for none.
    with redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        try:
            return _recorded(server, record, frames, theme)
        finally:
            server.stop()


def _recorded(
    server: viser.ViserServer, record: WalkRecord, frames: list[int], theme: Theme
) -> str:
    scene = server.scene
    scene.set_up_direction("+z")
    middle = float(np.mean(record.torso_position_m[frames, 0]))
    server.initial_camera.position = (middle + _EYE_M[0], _EYE_M[1], _EYE_M[2])
    server.initial_camera.look_at = (middle, 0.0, _HEIGHT_M)
    floor = FloorScene(scene, record.robot.sole_thickness_m, record.zmp_limit_m, theme)
    for which, points in (
        ("static_waist", record.static_waist_m),
        ("waist", record.waist_m),
    ):
        floor.draw_path(which, points[frames][np.isfinite(points[frames]).all(axis=1)])
    shown = RobotScene(scene, Robot(record.robot).urdf)
    serializer = server.get_scene_serializer()
    before = frames[0]
    for row in frames:
        serializer.insert_sleep(CONTROL_PERIOD_S * (row - before))
        before = row
        with server.atomic():
            shown.move(
                record.torso_position_m[row],
                record.torso_quaternion[row],
                record.joint_position_rad[row],
            )
            floor.place_zmp(record.zmp_m[row], record.zmp_reference_m[row])
            feet = np.array(standing_feet(record, row)).reshape(-1, 2)
            floor.place_support(sole_corners(record.robot, feet))
    return serializer.as_html(dark_mode=theme.dark)
