"""Write the topics of a bag as tables, Parquet or CSV; see `columns` for their form.

Every table is written whole or not at all, and none is replaced unless asked for.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.csv  # type: ignore[import-untyped]
import pyarrow.parquet  # type: ignore[import-untyped]

from biped_bag.columns import Row, row_maker
from biped_bag.errors import BagError
from biped_bag.storage.reader import BagReader
from biped_common.atomic_file import atomic_file

_ROWS_PER_BATCH = 10_000


@dataclass(frozen=True)
class ExportedTable:
    """One topic as a file."""

    topic: str
    file: Path
    rows: int


def _write_parquet(table: pa.Table, stream: IO[bytes]) -> None:
    pa.parquet.write_table(table, stream)


def _write_csv(table: pa.Table, stream: IO[bytes]) -> None:
    """Write lists as JSON text: CSV has none."""
    for i, column in enumerate(table.columns):
        if pa.types.is_list(column.type):
            texts = pa.array([json.dumps(value.as_py()) for value in column])
            table = table.set_column(i, table.column_names[i], texts)
    pa.csv.write_csv(table, stream)


FORMATS: Mapping[str, Callable[[pa.Table, IO[bytes]], None]] = {
    "parquet": _write_parquet,
    "csv": _write_csv,
}


def export(
    bag: BagReader,
    folder: Path,
    form: str,
    topics: Collection[str] | None = None,
    *,
    replace: bool = False,
) -> list[ExportedTable]:
    """Write one file per topic that has messages.

    Args:
        bag: to export.
        folder: of the files; made if need be.
        form: one of FORMATS.
        topics: to export; None exports all.
        replace: files that are there already.

    Raises:
        BagError: a topic is not in the bag, a message cannot be understood, or a file
            is there already or cannot be written.
    """
    files = {
        name: folder / f"{_file_stem(name)}.{form}"
        for name in bag.chosen(topics)
        if bag.topics[name].count
    }
    there = [file for file in files.values() if file.exists()]
    if there and not replace:
        raise BagError(f"{there[0]}: is there already; --force replaces it")
    done = []
    try:
        for name, file in files.items():
            table = topic_table(bag, name)
            folder.mkdir(parents=True, exist_ok=True)
            with atomic_file(file) as stream:
                FORMATS[form](table, stream)
            done.append(ExportedTable(name, file, table.num_rows))
    except OSError as error:
        raise BagError(f"{folder}: cannot be written to ({error.strerror})") from None
    return done


def topic_table(bag: BagReader, name: str) -> pa.Table:
    """Return all messages of a topic, one row each.

    Raises:
        BagError: a message cannot be understood.
    """
    batches = [pa.Table.from_pydict(columns) for columns in _batches(bag, name)]
    return pa.concat_tables(batches, promote_options="permissive")


def _batches(bag: BagReader, name: str) -> Iterator[dict[str, list[Any]]]:
    rows: list[Row] = []
    row_of = row_maker(bag.topics[name])
    for message in bag.messages([name]):
        try:
            row = row_of(message.data)
        except Exception as error:  # bytes that are not of the type fail anyhow
            raise _unreadable(bag, name, message.log_ns, error) from None
        rows.append({"log_time_ns": message.log_ns, **row})
        if len(rows) == _ROWS_PER_BATCH:
            yield _by_column(rows)
            rows = []
    if rows:
        yield _by_column(rows)


def _by_column(rows: list[Row]) -> dict[str, list[Any]]:
    """Turn rows into columns; a field that a message lacks is null."""
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: [row.get(name) for row in rows] for name in names}


def _unreadable(
    bag: BagReader, name: str, log_time_ns: int, error: Exception
) -> BagError:
    why = " ".join(str(error).split())
    return BagError(
        f"{bag.path}: {name}: the message logged at {log_time_ns} ns is not a "
        f"{bag.topics[name].type_name} of ours ({why})"
    )


def _file_stem(topic: str) -> str:
    """Return the topic with dots, which no topic has, in place of slashes."""
    return topic.strip("/").replace("/", ".")
