"""The page of a running graph in a real browser. The tests go on from one another."""

import time

import numpy as np
import pytest
import rclpy
from rosgraph_msgs.msg import Clock
from tests.biped_view.live.conftest import DOMAIN, until

MOVED = 15  # levels of grey
SOME_PIXELS = 50


@pytest.fixture(scope="module")
def tab(open_tab, address):
    tab = open_tab(address)
    tab.shows("Walking")
    until(lambda: np.ptp(tab.robot()) > 100, "the robot is drawn")
    return tab


@pytest.fixture(scope="module")
def ticking():
    """Return whether /clock goes on, over half a second."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    node = rclpy.create_node("clock_watch", context=context)
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(node)
    heard = []
    node.create_subscription(Clock, "/clock", heard.append, 1)

    def ticking():
        heard.clear()
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        return len(heard) > 1  # one may have waited

    yield ticking
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def moved(tab):
    """Pixels that change within a second."""
    before = tab.robot()
    time.sleep(1.0)
    return int((abs(tab.robot() - before) > MOVED).sum())


def test_the_robot_walks_on_the_page(tab):
    until(lambda: moved(tab) > SOME_PIXELS, "the robot moves")


def test_pause_stops_the_clock_and_resume_lets_it_go_on(tab, ticking):
    until(ticking, "the robot walks")
    tab.press("Pause")
    tab.shows("Paused")
    until(lambda: not ticking(), "the clock stands")
    until(lambda: moved(tab) == 0, "the robot stands")
    tab.press("Resume")
    until(ticking, "the clock goes on")
    tab.shows("Walking")


def test_the_learner_is_frozen_saved_and_let_learn_again(tab, graph):
    tab.press("Freeze")
    tab.shows("Frozen: greedy walks")
    memory = graph.folder / "memory.npz"
    memory.unlink(missing_ok=True)
    tab.press("Save")
    until(memory.exists, "the memory is saved")
    tab.press("Learn")
    tab.shows("Learning")


def test_a_walk_that_is_reset_is_told_as_that(tab):
    until(lambda: moved(tab) > SOME_PIXELS, "the robot walks")

    def reset():
        tab.press("Reset")  # between two walks there is none to end
        return tab.soon("last walk: reset")

    until(reset, "a walk that is reset is told as that")


def test_a_second_tab_shows_the_same(tab, open_tab, address):
    second = open_tab(address)
    second.shows("Walking")
    second.page.close()


def test_a_robot_that_is_started_anew_is_shown_anew(tab, graph):
    graph.end("sim_node")
    tab.shows("Silent")
    graph.start("sim_node")
    tab.shows("Walking")
    until(lambda: moved(tab) > SOME_PIXELS, "the robot moves")


def test_the_page_complains_of_nothing_and_asks_nobody_else(tab, address):
    assert tab.errors == []
    here = (address, address.replace("http", "ws"), "data:", "blob:")
    assert {url for url in tab.asked if not url.startswith(here)} == set()
