"""Pause, reset, save, freeze: what a user may ask of a running graph."""

import shutil

import pytest
from std_srvs.srv import SetBool, Trigger
from tests.graph.clients import TIMEOUT_S, Client, hashes, learned_in_process, quick

from biped_bringup.one_executor import OneExecutor
from biped_bringup.training import TrainingRun
from learner_node import checkpoint
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode

EPISODES = 5
PAUSE, RESET = "/sim_node/pause", "/sim_node/reset"
SAVE, FREEZE = "/learner_node/save_memory", "/learner_node/freeze"


def walking(graph):
    """Whether a walk is under way, after one that was learned from."""
    session = graph.learner.session
    return session.walking and session.episodes >= 1


def ticks_of(graph):
    return int(graph.sim.figures()["control ticks"])


def pause_in_a_walk(graph, client):
    assert graph.spin_until(lambda: walking(graph), TIMEOUT_S)
    assert client.call(SetBool, PAUSE, data=True).success


def result_of(message):
    return decode(EpisodeResult, message.data)


# -- pause -----------------------------------------------------------------------------


@pytest.mark.parametrize("pace", ["lockstep", "realtime"])
def test_a_pause_stops_the_robot(domain, pace):
    with OneExecutor(quick(pace=pace), domain) as graph, Client(graph) as client:
        assert graph.spin_until(lambda: ticks_of(graph) > 0, TIMEOUT_S)
        client.call(SetBool, PAUSE, data=True)
        graph.spin_until(lambda: False, 0.3)
        before = ticks_of(graph)
        graph.spin_until(lambda: False, 0.3)
        assert ticks_of(graph) == before


@pytest.mark.parametrize("times", [1, 2])
def test_a_paused_walk_goes_on_as_if_nothing_had_happened(domain, times):
    parameters = quick(max_episodes=EPISODES)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        pause_in_a_walk(graph, client)
        for _ in range(times - 1):
            client.call(SetBool, PAUSE, data=True)
        graph.spin_until(lambda: False, 0.2)
        client.call(SetBool, PAUSE, data=False)
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= EPISODES, TIMEOUT_S)
        assert hashes(session) == learned_in_process(EPISODES)
        assert graph.sim.counts["/biped/waist_reference refused"] == 0


# -- reset -----------------------------------------------------------------------------


def test_a_walk_that_was_reset_is_walked_again_as_if_nothing_had_happened(domain):
    parameters = quick(max_episodes=EPISODES)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        pause_in_a_walk(graph, client)
        graph.spin_until(lambda: False, 0.2)
        assert client.call(Trigger, RESET).success
        client.call(SetBool, PAUSE, data=False)
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= EPISODES, TIMEOUT_S)
        assert hashes(session) == learned_in_process(EPISODES)
        assert session.tally.given_up == {EndCause.RESET: 1}
        ends = [result_of(m).end_cause for m in client.messages[topics.EPISODE.name]]
        assert ends.count(EndCause.RESET) == 1


def test_a_frozen_learner_is_not_done_with_a_walk_that_was_reset(domain):
    parameters = quick(frozen=True, max_episodes=1)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        session = graph.learner.session
        # As in a memory that was learned, trials included.
        session.tally.evaluations = 1
        assert graph.spin_until(lambda: session.walking, TIMEOUT_S)
        client.call(SetBool, PAUSE, data=True)
        assert client.call(Trigger, RESET).success
        client.call(SetBool, PAUSE, data=False)
        assert graph.spin_until(lambda: session.tally.evaluations == 2, TIMEOUT_S)


@pytest.mark.parametrize("paused", [False, True])
def test_after_a_reset_walks_begin_clean(domain, paused):
    # Who knows nothing and learns nothing walks the same static walk again and again.
    parameters = quick(frozen=True)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        whole = client.wait_for(topics.EPISODE, lambda _: True)
        if paused:
            client.call(SetBool, PAUSE, data=True)
            graph.spin_until(lambda: False, 0.2)
        assert graph.spin_until(lambda: graph.learner.session.walking, TIMEOUT_S)
        assert client.call(Trigger, RESET).success
        if paused:
            client.call(SetBool, PAUSE, data=False)
        after = client.wait_for(
            topics.EPISODE, lambda m: result_of(m).end_cause is not EndCause.RESET
        )
        hashes = {result_of(m).trajectory_sha256 for m in (whole, after)}
        assert len(hashes) == 1


def test_where_nobody_walks_there_is_nothing_to_reset(domain):
    # A learner that still listens takes no part.
    with OneExecutor(quick(listen_s=60.0), domain) as graph, Client(graph) as client:
        response = client.call(Trigger, RESET)
        assert (response.success, response.message) == (False, "no walk to end")


# -- save ------------------------------------------------------------------------------


def test_between_walks_the_memory_is_saved_at_once(domain, tmp_path):
    file = tmp_path / "memory.npz"
    parameters = quick(checkpoint_file=str(file), max_episodes=2)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == 2, TIMEOUT_S)
        file.unlink(missing_ok=True)
        assert client.call(Trigger, SAVE).message == f"saved to {file}"
        run = TrainingRun.load(file)
        run.close()
        assert hashes(run.session) == hashes(session)


def test_in_a_walk_the_memory_is_saved_at_its_end(domain, tmp_path):
    file = tmp_path / "memory.npz"
    parameters = quick(checkpoint_file=str(file), max_episodes=EPISODES)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        pause_in_a_walk(graph, client)
        response = client.call(Trigger, SAVE)
        assert response.message == f"will be saved to {file} at the walk's end"
        assert (response.success, file.exists()) == (True, False)
        walked = graph.learner.session.episodes
        client.call(SetBool, PAUSE, data=False)
        assert graph.spin_until(file.exists, TIMEOUT_S)
        run = TrainingRun.load(file)
        run.close()
        assert run.episodes > walked


def test_a_memory_that_nobody_keeps_cannot_be_saved(domain):
    with OneExecutor(quick(listen_s=60.0), domain) as graph, Client(graph) as client:
        response = client.call(Trigger, SAVE)
        assert (response.success, response.message) == (
            False,
            "no checkpoint file was given at the start",
        )


def test_a_folder_that_is_gone_is_named(domain, tmp_path):
    file = tmp_path / "gone" / "memory.npz"
    file.parent.mkdir()
    parameters = quick(checkpoint_file=str(file), listen_s=60.0)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        shutil.rmtree(file.parent)
        response = client.call(Trigger, SAVE)
        assert not response.success
        assert response.message.startswith(f"{file}: its folder is not there")


def test_a_save_that_fails_is_told_and_ends_nothing(domain, tmp_path):
    file = tmp_path / "memory.npz"
    parameters = quick(checkpoint_file=str(file), max_episodes=2)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.DIAGNOSTICS) as client,
    ):
        file.mkdir()  # which no file can take the place of
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == 2, TIMEOUT_S)
        response = client.call(Trigger, SAVE)
        told = f"{file}: cannot be written: Is a directory"
        assert (response.success, response.message) == (False, told)
        client.wait_for(
            topics.DIAGNOSTICS, lambda m: any(told in s.message for s in m.status)
        )
        file.rmdir()
        assert client.call(Trigger, SAVE).success


def test_a_memory_that_has_grown_too_large_is_told_and_ends_nothing(
    domain, tmp_path, monkeypatch
):
    monkeypatch.setattr(checkpoint, "MOST_BYTES", 1000)
    file = tmp_path / "memory.npz"
    parameters = quick(checkpoint_file=str(file), max_episodes=2)
    with OneExecutor(parameters, domain) as graph, Client(graph) as client:
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == 2, TIMEOUT_S)
        response = client.call(Trigger, SAVE)
        assert (response.success, file.exists()) == (False, False)
        assert response.message.endswith("bytes, 1000 at most")


# -- freeze ----------------------------------------------------------------------------


def test_a_frozen_learner_walks_greedily_and_keeps_its_memory(domain):
    with (
        OneExecutor(quick(), domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        session = graph.learner.session
        pause_in_a_walk(graph, client)
        client.call(SetBool, FREEZE, data=True)
        client.call(SetBool, PAUSE, data=False)
        client.wait_for(topics.EPISODE, lambda m: not result_of(m).learning)
        before = hashes(session), session.episodes
        for _ in range(2):
            client.wait_for(topics.EPISODE, lambda m: not result_of(m).learning)
        assert (hashes(session), session.episodes) == before


def test_a_learner_that_is_no_longer_frozen_learns_on(domain):
    with (
        OneExecutor(quick(frozen=True), domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        client.wait_for(topics.EPISODE, lambda m: not result_of(m).learning)
        client.call(SetBool, FREEZE, data=False)
        client.wait_for(topics.EPISODE, lambda m: result_of(m).learning)
        assert graph.learner.session.episodes >= 1
