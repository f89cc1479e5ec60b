"""One row per learning episode: how far it came, against which target, and why."""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import seconds
from msgs_json.bounds import MOST_TICKS
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult

_CAUSES = tuple(EndCause)
_TYPES = {
    "control_ticks": np.int64,
    "target_ticks": np.int64,
    "end_cause": np.int64,
    "reward": np.float64,
    "t_err": np.float64,
    "peak_zmp_error_m": np.float64,
}
_RANGES = {
    "control_ticks": (0, MOST_TICKS),
    "target_ticks": (1, MOST_TICKS),
    "end_cause": (0, len(_CAUSES) - 1),
    "reward": (0.0, sys.float_info.max),
    "t_err": (0.0, sys.float_info.max),
    "peak_zmp_error_m": (0.0, sys.float_info.max),
}


class EpisodeLog:
    """Columns that grow by an episode at a time."""

    def __init__(self, columns: Mapping[str, NDArray[Any]] | None = None) -> None:
        """Start empty, or with what `arrays` returned.

        Raises:
            ValueError: a column is missing, of another type or length, or holds what
                no episode can have been.
        """
        self._columns: dict[str, list[Any]] = {name: [] for name in _TYPES}
        if columns is not None:
            if set(columns) != set(_TYPES):
                raise ValueError(f"episode log: columns {sorted(columns)}")
            for name, column in columns.items():
                if column.ndim != 1 or column.dtype != _TYPES[name]:
                    raise ValueError(
                        f"episode log: {name} is {column.dtype}{column.shape}, "
                        f"must be a list of {np.dtype(_TYPES[name])}"
                    )
            if len({len(column) for column in columns.values()}) > 1:
                raise ValueError("episode log: columns of different length")
            for name, column in columns.items():
                low, high = _RANGES[name]
                sound = (low <= column) & (column <= high)
                if name == "t_err":
                    sound |= np.isnan(column)  # of walks that cannot be judged
                if not sound.all():
                    raise ValueError(f"episode log: {name} is {column[~sound][0]}")
            self._columns = {name: columns[name].tolist() for name in _TYPES}

    def __len__(self) -> int:
        """Return the number of episodes."""
        return len(self._columns["control_ticks"])

    def append(self, result: EpisodeResult) -> None:
        """Add an episode."""
        row = {
            "control_ticks": result.control_ticks,
            "target_ticks": result.target_ticks,
            "end_cause": _CAUSES.index(result.end_cause),
            "reward": result.reward,
            "t_err": float("nan") if result.cost is None else result.cost.total,
            "peak_zmp_error_m": result.peak_zmp_error_m,
        }
        for name, value in row.items():
            self._columns[name].append(value)

    def survival(self, last: int = 20) -> float:
        """Return walked over target time, averaged over the last episodes."""
        walked = self._columns["control_ticks"][-last:]
        target = self._columns["target_ticks"][-last:]
        return sum(walked) / sum(target) if target else 0.0

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the columns for a checkpoint."""
        return {
            name: np.array(column, dtype=_TYPES[name])
            for name, column in self._columns.items()
        }

    def csv_text(self) -> str:
        """Return the log as CSV, times in seconds, causes in words."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(
            ["episode", "walked_s", "target_s", "end_cause", "reward", "t_err",
             "peak_zmp_error_m"]
        )  # fmt: skip
        rows = zip(*(self._columns[name] for name in _TYPES), strict=True)
        for episode, (ticks, target, cause, reward, t_err, peak) in enumerate(rows, 1):
            writer.writerow(
                [episode, f"{seconds(ticks):.3f}", f"{seconds(target):.3f}",
                 _CAUSES[cause], reward, t_err, peak]
            )  # fmt: skip
        return stream.getvalue()
