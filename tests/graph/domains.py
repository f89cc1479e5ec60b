"""ROS domains for tests: parallel tests must not meet.

The workers of one run have ranges that never overlap. Runs of several people on one
machine begin at different places, so that they seldom meet.
"""

import os
import zlib

PER_WORKER = 30
# The first ones go round among the tests, so that none is used again at once: what one
# leaves behind takes a while to go. The others are modules' own.
SHARED = 25
MODULE = 25
_FIRST, _COUNT = 2, 98  # 0 is everybody's default, beyond 101 ports run out somewhere


def own_domain(number: int) -> int:
    """Return one of the domains of this worker, 0 <= number < PER_WORKER."""
    run = os.environ.get("PYTEST_XDIST_TESTRUNUID", str(os.getpid()))
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    place = zlib.crc32(run.encode()) + worker * PER_WORKER + number
    return _FIRST + place % _COUNT
