"""Ctrl-C while a program loads: the signal ends it, whatever an import makes of it."""

import signal
import subprocess
import sys

import pytest

INTERRUPTED = """
import os, signal
from biped_common.signals import loading
{before}
with loading():
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except BaseException:
        pass
print("went on")
"""


def status(before=""):
    """Return how a program ends that swallows what an interrupt raises."""
    code = INTERRUPTED.format(before=before)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    return done.returncode, done.stdout


def test_an_interrupt_cannot_be_swallowed():
    assert status() == (-signal.SIGINT, "")


def test_who_has_had_it_ignored_goes_on():
    before = "signal.signal(signal.SIGINT, signal.SIG_IGN)"
    assert status(before) == (0, "went on\n")


@pytest.mark.parametrize("handler", ["default_int_handler", "SIG_IGN"])
def test_afterwards_it_is_as_before(handler):
    code = f"""
import signal
from biped_common.signals import loading
signal.signal(signal.SIGINT, signal.{handler})
with loading():
    pass
assert signal.getsignal(signal.SIGINT) is signal.{handler}
"""
    subprocess.run([sys.executable, "-c", code], check=True)
