"""`biped demo`: what a newcomer is told of three walks, and where they lie."""

import re
import shlex

import pytest
from tests.graph.players import SAMPLE

from biped_bag.storage.reader import BagReader
from biped_bringup.cli import demo
from biped_bringup.cli.main import parser


@pytest.mark.thorough
def test_the_static_walk_is_seen_to_fail_and_a_short_run_learns_nothing(
    biped_process, tmp_path, domain, monkeypatch
):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    ended = biped_process("demo", "--episodes", "1", "--out", tmp_path / "out")
    lines = ended.out.splitlines()
    assert ended.status == 1, ended.err
    assert re.fullmatch(r"live page: http://127\.0\.0\.1:\d+", lines[0])
    assert lines[1].startswith("1 of 3  the walk as it was planned")
    assert "        zmp_error after 2.26 s, peak ZMP error 65.0 mm" in lines
    assert lines[-1] == "        not learned yet: 1 episodes"
    assert {file.name for file in (tmp_path / "out").glob("*.npz")} == {"memory.npz"}


@pytest.mark.thorough
def test_a_learned_walk_is_shown_and_the_commands_to_try_next_are_real(
    domain, tmp_path, capfd, monkeypatch
):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    (memory,) = BagReader(SAMPLE).attachments()
    (tmp_path / "memory.npz").write_bytes(memory.data)
    shows = demo.Demo(tmp_path, with_page=False)
    walked, status = shows.up("--greedy")
    assert (status, walked["end_cause"]) == (0, "completed")
    shows.show_results(walked)
    lines = capfd.readouterr().out.splitlines()
    assert lines[0].split() == ["memory", str(tmp_path / "memory.npz")]
    assert re.fullmatch(rf"bag        {tmp_path}/bag_\w+", lines[1])
    assert lines[2].split() == ["report", str(tmp_path / "report.html")]
    assert (tmp_path / "report.html").read_text().startswith("<!DOCTYPE html>")
    commands = [line for line in lines if line.startswith("           biped ")]
    assert len(commands) == 3
    for command in commands:
        words = shlex.split(command, comments=True)[1:]
        assert parser(words).parse_args(words).run is not None
