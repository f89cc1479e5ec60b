"""The page beside a run, as the supervisor keeps it."""

import os
import signal
import time
import urllib.request

from biped_bringup.supervisor.live_page import LivePage

TIMEOUT_S = 60.0


def answers(address):
    try:
        with urllib.request.urlopen(address, timeout=5.0) as response:
            return response.status == 200
    except OSError:
        return False


def until(condition):
    end = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_a_page_is_announced_started_again_when_it_dies_and_ended(
    domain, tmp_path, monkeypatch
):
    # Pages of other tests would take the port over while nobody has it.
    monkeypatch.setattr("biped_bringup.supervisor.live_page._FIRST_PORT", 8310)
    said = []
    page = LivePage(
        os.environ | {"ROS_DOMAIN_ID": str(domain)},
        tmp_path,
        tmp_path / "memory.npz",
        lambda _, line: said.append(line),
    )
    page.start()
    assert said == [f"live page: {page.address}"]
    try:
        until(lambda: answers(page.address))
        first = page._child.pid
        os.kill(first, signal.SIGKILL)
        until(lambda: page._child.pid is None)
        until(lambda: page.look_after() or page._child.pid not in (None, first))
        until(lambda: answers(page.address))
    finally:
        page.stop()
    assert page._child.exit_status == 0
    assert not answers(page.address)
