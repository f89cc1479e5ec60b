"""DDS Security: asked for in vain, it is refused, and not left out in silence."""

import os
import subprocess
import sys

import pytest

REFUSED = "ROS_SECURITY_ENABLE=true: the Fast DDS of the wheels is built without"


@pytest.mark.parametrize(
    "command",
    [
        ("biped_bringup.cli.main", "up", "--record", "none", "--no-view"),
        ("trajectory_node.node",),
    ],
    ids=["biped up", "a node"],
)
def test_security_that_the_middleware_lacks_is_refused_in_one_line(tmp_path, command):
    ended = subprocess.run(
        [sys.executable, "-m", *command],
        cwd=tmp_path,
        env=os.environ | {"ROS_SECURITY_ENABLE": "true"},
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    lines = ended.stderr.splitlines()
    assert (ended.returncode, len(lines)) == (2, 1)
    assert REFUSED in lines[0]
