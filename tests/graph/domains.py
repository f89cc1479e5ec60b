"""ROS domains for tests: parallel runs must not meet, neither two workers of one run
nor the runs of two people on one machine."""

import os

PER_PROCESS = 10
# The first ones go round among the tests, the others are modules' own.
SHARED = 5
MODULE = 5
_FIRST, _COUNT = 2, 98  # 0 is everybody's default, beyond 101 ports run out somewhere


def own_domain(number: int) -> int:
    """Return one of the domains of this process, 0 <= number < PER_PROCESS."""
    return _FIRST + (os.getpid() * PER_PROCESS + number) % _COUNT
