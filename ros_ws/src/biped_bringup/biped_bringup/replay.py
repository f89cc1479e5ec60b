"""Exact replay: what was walked before comes out of memory, not out of the physics.

A walk without chance is decided by its corrections, and fixed states repeat theirs. A
tree holds all walks: an edge is the correction of a learning tick, a node the
observation that came of it. Walks follow the tree as far as it goes; the physics is put
in place and computes where a walk leaves it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import Responder, Walker
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from sim_node.biped import BipedSnapshot

DEFAULT_MEMORY_BYTES = 200_000_000
# What they take in the process; benchmarks/replay.py asks the system if it is true.
NODE_BYTES = 1_250
SNAPSHOT_BYTES = 165_000
# To keep a snapshot takes the physics as long as two learning ticks. Walks leave the
# tree at the same few nodes again and again: there it is worth it, unless another is
# near; and once on the new way, for those that will soon leave it.
_NEAR_TICKS = 4
_ON_THE_WAY_TICKS = 32

Answer = NDArray[np.float64] | EpisodeResult


class _Snapshot(NamedTuple):
    """Robot and reference in the middle of a walk."""

    biped: BipedSnapshot
    reference: dict[str, Any]


@dataclass(slots=True, eq=False)
class _Node:
    """Where a certain sequence of corrections has led to, at a learning tick."""

    correction: bytes
    """The last one of the sequence, (2,) float64 [m]."""
    observation: Observation
    """Episode and clock are those of the robot when it was here."""
    clock_ticks: int
    """Since the walk began. An end that comes without a control tick takes one, too."""
    last_walk: int
    """Number of the last walk that came here, at least that of all nodes after it."""
    snapshot: _Snapshot | None = None
    after: tuple[_Node, ...] = ()

    def known(self, correction: bytes) -> _Node | None:
        """Return the node that a correction leads to, if it was tried here before."""
        for node in self.after:
            if node.correction == correction:
                return node
        return None

    def subtree(self) -> Iterator[_Node]:
        """Yield this node, then all that come after it."""
        pending = [self]
        while pending:
            node = pending.pop()
            pending.extend(node.after)
            yield node

    @property
    def own_bytes(self) -> int:
        """Memory of this node alone."""
        return NODE_BYTES if self.snapshot is None else NODE_BYTES + SNAPSHOT_BYTES


class ReplayingWalker(Walker):
    """A walker that computes nothing twice, bit for bit as if it did."""

    def __init__(
        self,
        settings: RunSettings,
        rng: np.random.Generator,
        memory_bytes: int = DEFAULT_MEMORY_BYTES,
    ) -> None:
        """Plan the gait and build the world; know no walk yet.

        Args:
            settings: of the whole run, without chance (`SimSettings.random`).
            rng: not drawn from.
            memory_bytes: bound of the tree. When a walk has led beyond it, the tree
                forgets half of itself, first what was walked least recently.

        Raises:
            ValueError: chance has a part in the walks.
        """
        if settings.sim.random:
            raise ValueError("walks in which chance has a part cannot be replayed")
        super().__init__(settings, rng)
        self._memory_bytes = memory_bytes
        self.used_bytes = 0
        """What the tree takes at present."""
        self._root: _Node | None = None
        self._robot_at: _Node | None = None
        """Where robot and reference stand, None for elsewhere."""
        self._clock_ticks = self._begun_ticks = self.biped.clock_ticks
        """The clock as if all was computed: now, and when the walk began."""

    def walk(self, responder: Responder) -> EpisodeResult:
        """Walk until the responder gives a result."""
        self._walks += 1
        self._begun_ticks = self._clock_ticks + 1
        if self._root is None:
            self._root = self._new_node(b"", self._begin(), 0)
            self._robot_at = self._root
        path = [self._root]
        answer = self._ask(responder, self._root)
        while not isinstance(answer, EpisodeResult):
            known = path[-1].known(answer.tobytes())
            if known is None:
                break
            path.append(known)
            answer = self._ask(responder, known)
        self.ticks.replayed += path[-1].observation.control_tick
        if not isinstance(answer, EpisodeResult):
            answer = self._walk_on(path, answer, responder)
        if self.used_bytes > self._memory_bytes:
            self._forget(self._memory_bytes // 2)
        return answer

    def close(self) -> None:
        """Forget all walks and end the world."""
        if self._root is not None:
            self._forget(0)
        self._root = None
        super().close()

    def _ask(self, responder: Responder, node: _Node) -> Answer:
        node.last_walk = self._walks
        self._clock_ticks = self._begun_ticks + node.clock_ticks
        return responder.respond(
            replace(
                node.observation, episode=self._walks, clock_ticks=self._clock_ticks
            )
        )

    # -- beyond the tree -----------------------------------------------------------

    def _walk_on(
        self, path: list[_Node], answer: Answer, responder: Responder
    ) -> EpisodeResult:
        """Compute the rest of a walk, from the end of its known path on."""
        node, ticks = path[-1], 0
        if node is not self._robot_at:
            self._take_robot_to(path)
        while not isinstance(answer, EpisodeResult):
            before = self.biped.clock_ticks
            observation = self._execute(answer)
            clock_ticks = node.clock_ticks + self.biped.clock_ticks - before
            following = self._new_node(answer.tobytes(), observation, clock_ticks)
            node.after += (following,)
            self._robot_at = node = following
            ticks += 1
            if ticks == _ON_THE_WAY_TICKS:
                self._keep_snapshot(node)
            answer = self._ask(responder, node)
        return answer

    def _take_robot_to(self, path: list[_Node]) -> None:
        """Put robot and reference at the end of a path from the root.

        What lies behind the last snapshot on the path is executed again.
        """
        at = len(path) - 1
        while at > 0 and path[at].snapshot is None:
            at -= 1
        snapshot = path[at].snapshot
        if snapshot is None:
            self._begin()
        else:
            self.biped.restore(snapshot.biped)
            self.reference.restore(snapshot.reference)
        again = path[at + 1 :]
        for node in again:
            self._execute(np.frombuffer(node.correction))
        self._robot_at = path[-1]
        if len(again) >= _NEAR_TICKS:
            self._keep_snapshot(path[-1])

    def _begin(self) -> Observation:
        self.reference.reset()
        return self.biped.begin_walk(self._walks)

    def _execute(self, correction_m: NDArray[np.float64]) -> Observation:
        self._robot_at = None  # until it is there
        before = self.biped.control_tick
        observation = self.biped.execute(self.reference.segment(correction_m))
        self.ticks.computed += observation.control_tick - before
        return observation

    # -- memory --------------------------------------------------------------------

    def _new_node(
        self, correction: bytes, observation: Observation, clock_ticks: int
    ) -> _Node:
        node = _Node(correction, observation, clock_ticks, self._walks)
        self.used_bytes += node.own_bytes
        return node

    def _keep_snapshot(self, node: _Node) -> None:
        self.used_bytes -= node.own_bytes
        node.snapshot = _Snapshot(self.biped.snapshot(), self.reference.snapshot())
        self.used_bytes += node.own_bytes

    def _forget(self, kept_bytes: int) -> None:
        """Forget what was walked least recently, but never the root."""
        assert self._root is not None
        nodes = list(self._root.subtree())
        sizes: Counter[int] = Counter()
        for node in nodes:
            sizes[node.last_walk] += node.own_bytes
        used, oldest_kept = 0, self._walks + 1
        for walk in sorted(sizes, reverse=True):
            used += sizes[walk]
            if used > kept_bytes:
                break
            oldest_kept = walk
        self.used_bytes = 0
        for node in nodes:
            if node.last_walk >= oldest_kept or node is self._root:
                node.after = tuple(n for n in node.after if n.last_walk >= oldest_kept)
                self.used_bytes += node.own_bytes
            elif node.snapshot is not None:
                self.biped.release(node.snapshot.biped)
