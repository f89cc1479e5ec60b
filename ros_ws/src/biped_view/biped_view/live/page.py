"""The page of one viser server, on this machine only: scene, plots, cards, buttons.

Everything is drawn by the thread that calls `turn`; what a browser asks for waits until
then. Nothing is drawn while nobody looks, and who comes sees the last moment.
"""

from __future__ import annotations

import io
import queue
import socket
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from typing import Any, Final

import viser

from biped_common.errors import BipedError
from biped_description.robot import Robot
from biped_view.floor_scene import FloorScene
from biped_view.live import cards
from biped_view.live.moment import (
    NO_TRACES,
    Course,
    Episodes,
    LearnerFigures,
    Moment,
    Traces,
)
from biped_view.live.plots import Plots
from biped_view.robot_scene import RobotScene
from biped_view.theme import DARK, LIGHT, Colour
from learner_node.walking.waist_plane import LearnedStates

HOST: Final = "127.0.0.1"
FIRST_PORT: Final = 8080
FRAME_S: Final = 1.0 / 30.0
_PLOT_S, _PATHS_S = 0.2, 0.1
_PANEL_PX: Final = 320
_CAMERA_M, _LOOK_AT_M = (1.45, -1.1, 0.85), (0.25, 0.0, 0.44)
_PATH_POINTS: Final = 150
_USUAL_SOLE_M: Final = 0.03


class PortError(BipedError):
    """The page cannot have the port that was asked for."""


class _Server(viser.ViserServer):
    """A server that is never shared beyond this machine, whatever a client asks."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: viser would open a tunnel to a public address."""
        return None


def _refuse_unusable(port: int) -> None:
    """Refuse a port that cannot be listened on; viser would wait for it for ever."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            raise PortError(f"port {port} on {HOST}: {error.strerror}") from None


class Page:
    """What a browser shows; sources of walks and learners fill it."""

    def __init__(self, title: str, port: int | None = None, dark: bool = False) -> None:
        """Serve the page, still empty.

        Args:
            title: of the panel.
            port: to serve on; None: 8080, or the first free one after it.
            dark: begin in the dark theme.

        Raises:
            PortError: the port cannot be had.
        """
        if port:
            _refuse_unusable(port)
        with redirect_stdout(io.StringIO()):  # viser announces itself
            self._server = _Server(
                HOST, FIRST_PORT if port is None else port, title, verbose=False
            )
        bound = self._server.get_port()
        if port and bound != port:
            self.close()
            raise PortError(f"port {port} is taken on {HOST}")
        self.address = f"http://{HOST}:{bound}"
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._theme = DARK if dark else LIGHT
        self._floor: FloorScene | None = None
        self._robot: RobotScene | None = None
        self._course: Course | None = None
        self._moment: Callable[[], Moment] | None = None
        self._traces: Callable[[], Traces] = lambda: NO_TRACES
        self._episodes: Episodes | None = None
        self._figures: LearnerFigures | None = None
        self._map: tuple[LearnedStates, str] | None = None
        self._head: tuple[str, str, Colour] = ("Waiting", "", self._theme.soft)
        self._stale = {"moment", "plots", "cards"}
        self._plotted_at = self._paths_at = 0.0
        self._lay_out()
        # Whoever comes gets plots drawn anew, once they have their size.
        self._server.on_client_connect(
            lambda _: self._ask(lambda: self._stale.add("plots"))
        )

    # -- what a source tells ---------------------------------------------------------

    def set_stage(
        self,
        robot: Robot | str,
        zmp_limit_m: float,
        walk_s: float,
    ) -> None:
        """Put a robot on the floor.

        Args:
            robot: or its URDF, where its table is not known.
            zmp_limit_m: norm of the ZMP error at which the walk fails.
            walk_s: time of the whole walk.
        """
        scene = self._server.scene
        if isinstance(robot, Robot):
            urdf, sole_m = robot.urdf, robot.settings.sole_thickness_m
        else:
            urdf, sole_m = robot, _USUAL_SOLE_M
        self._robot = RobotScene(scene, urdf)
        self._floor = FloorScene(scene, sole_m, zmp_limit_m, self._theme)
        self._course = None
        self._plots.set_walk(zmp_limit_m, walk_s)
        self._paint()

    def set_course(self, course: Course) -> None:
        """Show the walk as planned."""
        self._course = course
        self._paint_course()

    def show_moment(self, moment: Callable[[], Moment]) -> None:
        """Show the robot; `moment` is called when it is drawn, if somebody looks."""
        self._moment = moment
        self._stale.add("moment")

    def show_traces(self, traces: Callable[[], Traces]) -> None:
        """Show what was measured along the walk; called when it is drawn."""
        self._traces = traces
        self._stale.add("plots")

    def show_episodes(self, episodes: Episodes) -> None:
        """Show T_err of the episodes so far."""
        self._episodes = episodes
        self._stale.add("plots")

    def show_learner(self, figures: LearnerFigures) -> None:
        """Show how far the learner has come."""
        self._figures = figures
        self._stale.add("cards")

    def show_map(self, learned: LearnedStates, as_of: str) -> None:
        """Show the learner's states; `as_of` says how old they are."""
        self._map = learned, as_of
        self._stale.add("cards")

    def show_state(self, state: str, detail: str, good: bool | None) -> None:
        """Show what goes on.

        Args:
            state: in a word or two.
            detail: one line.
            good: True: as it should be, False: not, None: neither.
        """
        theme = self._theme
        colour = theme.soft if good is None else theme.fixed if good else theme.penalty
        if self._head != (state, detail, colour):
            self._head = state, detail, colour
            self._stale.add("cards")

    # -- what a user asks for --------------------------------------------------------

    def add_buttons(
        self, label: str, options: tuple[str, ...], pressed: Callable[[str], None]
    ) -> None:
        """Add a row of buttons; `pressed` is told which, by the thread of `turn`."""
        with self._controls:
            row = self._server.gui.add_button_group(label, options)
        row.on_click(lambda event: self._ask(lambda: pressed(event.target.value)))

    def add_time_slider(
        self, last_s: float, step_s: float, moved: Callable[[float], None]
    ) -> Callable[[float], None]:
        """Add a slider over the time of a walk.

        Returns:
            To be told the time where it is not the user who moves it.
        """
        with self._controls:
            slider = self._server.gui.add_slider("Time [s]", 0.0, last_s, step_s, 0.0)

        def on_update(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:  # else it was moved from here
                self._ask(lambda: moved(event.target.value))

        slider.on_update(on_update)
        return lambda time_s: setattr(slider, "value", time_s)

    def say(self, title: str, text: str) -> None:
        """Answer what a user asked for, for some seconds."""
        for client in self._server.get_clients().values():
            client.add_notification(title, text, auto_close_seconds=4.0)

    def _ask(self, what: Callable[[], None]) -> None:
        self._requests.put(what)

    # -- the loop --------------------------------------------------------------------

    def turn(self) -> None:
        """Do what was asked for, and draw what has changed."""
        while not self._requests.empty():
            self._requests.get()()
        if not self._server.get_clients() or not self._stale:
            return
        if "moment" in self._stale:
            self._stale.remove("moment")
            self._draw_moment()
        if time.monotonic() - self._plotted_at >= _PLOT_S:
            self._plotted_at = time.monotonic()
            if "plots" in self._stale:
                self._stale.remove("plots")
                self._plots.show_walk(self._traces())
                if self._episodes is not None:
                    self._plots.show_episodes(self._episodes)
            if "cards" in self._stale:
                self._stale.remove("cards")
                self._draw_cards()

    def run(self, source_turn: Callable[[], None], stopped: Callable[[], bool]) -> None:
        """Take turns with a source, 30 times a second, until stopped."""
        while not stopped():
            begun = time.monotonic()
            source_turn()
            self.turn()
            time.sleep(max(0.0, FRAME_S - (time.monotonic() - begun)))

    def close(self) -> None:
        """Serve no longer."""
        with redirect_stdout(io.StringIO()):
            self._server.stop()

    # -- drawing ---------------------------------------------------------------------

    def _lay_out(self) -> None:
        server, gui = self._server, self._server.gui
        server.initial_camera.position = _CAMERA_M
        server.initial_camera.look_at = _LOOK_AT_M
        gui.main_panel.dock_right()
        gui.main_panel.set_width(_PANEL_PX)
        self._headline = gui.add_html("")
        self._controls = gui.add_folder("Controls")
        # What nothing is known of is not shown.
        self._learner_folder = gui.add_folder("Learner", visible=False)
        with self._learner_folder:
            self._learner = gui.add_html("")
        self._map_folder = gui.add_folder("States over the waist plane", visible=False)
        with self._map_folder:
            self._state_map = gui.add_html("")
        dark = gui.add_checkbox("Dark", self._theme.dark)
        dark.on_update(lambda event: self._ask(lambda: self._dark(event.target.value)))
        side = gui.add_panel()
        side.dock_left()
        side.set_width(_PANEL_PX)
        with side.add_tab("Walk and episodes"):
            self._plots = Plots(gui, self._theme)
            self._legend = gui.add_html(cards.legend(self._theme))
        self._paint()

    def _dark(self, dark: bool) -> None:
        self._theme = DARK if dark else LIGHT
        self._paint()

    def _paint(self) -> None:
        theme = self._theme
        self._server.gui.configure_theme(
            dark_mode=theme.dark,
            show_logo=False,
            show_share_button=False,
            brand_color=theme.zmp_reference,
        )
        self._legend.content = cards.legend(theme)
        if self._floor is not None:
            self._floor.paint(theme)
            self._paint_course()
        self._plots.paint(theme)
        self._stale |= {"moment", "plots", "cards"}

    def _paint_course(self) -> None:
        if self._floor is None or self._course is None:
            return
        for which, path in (
            ("static_waist", self._course.static_waist_m),
            ("left", self._course.left_foot_m),
            ("right", self._course.right_foot_m),
        ):
            stride = max(1, len(path) // _PATH_POINTS)
            self._floor.draw_path(which, path[::stride])

    def _draw_moment(self) -> None:
        if self._moment is None or self._robot is None or self._floor is None:
            return
        moment = self._moment()
        with self._server.atomic():
            self._robot.move(
                moment.torso_position_m,
                moment.torso_quaternion,
                moment.joint_position_rad,
            )
            self._floor.place_zmp(moment.zmp_m, moment.zmp_reference_m)
            self._floor.place_support(moment.support_m)
            if time.monotonic() - self._paths_at >= _PATHS_S:
                self._paths_at = time.monotonic()
                stride = max(1, len(moment.waist_m) // _PATH_POINTS)
                self._floor.draw_path("waist", moment.waist_m[::stride])
                self._floor.draw_path("waist_ahead", moment.waist_ahead_m)

    def _draw_cards(self) -> None:
        self._headline.content = cards.headline(*self._head)
        if self._figures is not None:
            self._learner.content = cards.learner_card(self._figures, self._theme)
            self._learner_folder.visible = True
        if self._map is not None:
            self._state_map.content = cards.state_map(*self._map, self._theme)
            self._map_folder.visible = True
