"""Write the topics of a bag as tables, Parquet or CSV; see `columns` for their form.

Every table is written whole or not at all, and none is replaced unless asked for.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from biped_bag.columns import Row, row_maker
from biped_bag.errors import BagError
from biped_bag.storage.reader import BagReader
from biped_common.atomic_file import atomic_file

_ROWS_PER_BATCH = 10_000
_BYTES_PER_BATCH = 2**22  # of messages; as Python's objects they take ten times that


@dataclass(frozen=True)
class ExportedTable:
    """One topic as a file."""

    topic: str
    file: Path
    rows: int


FORMATS: Mapping[str, Callable[[IO[bytes], pa.Schema], Any]] = {
    "parquet": pa.parquet.ParquetWriter,
    "csv": pa.csv.CSVWriter,
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
    if len(set(files.values())) < len(files):
        raise BagError(f"{bag.path}: topics whose tables would have the same name")
    there = [file for file in files.values() if file.exists()]
    if there and not replace:
        raise BagError(f"{there[0]}: is there already; --force replaces it")
    done = []
    new = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, file in files.items():
            with atomic_file(file) as stream:
                try:
                    rows = _write(bag, name, FORMATS[form], form == "csv", stream)
                except pa.ArrowException as error:
                    why = " ".join(str(error).split())
                    raise BagError(
                        f"{bag.path}: {name}: its messages make no table ({why})"
                    ) from None
            done.append(ExportedTable(name, file, rows))
    except OSError as error:
        raise BagError(f"{folder}: cannot be written to ({error.strerror})") from None
    finally:
        if new and not done:
            with suppress(OSError):
                folder.rmdir()
    return done


def _write(
    bag: BagReader,
    name: str,
    make_writer: Callable[[Any, pa.Schema], Any],
    lists_as_text: bool,
    stream: IO[bytes],
) -> int:
    """Write a topic's rows by the batch; return how many there are.

    The topic is read twice: what columns there are, only its last message tells.
    """
    schema = pa.schema([])
    for table in _tables(bag, name, lists_as_text):
        schema = pa.unify_schemas([schema, table.schema], promote_options="permissive")
    rows = 0
    with make_writer(stream, schema) as writer:
        for table in _tables(bag, name, lists_as_text):
            empty = schema.empty_table()
            whole = pa.concat_tables([empty, table], promote_options="permissive")
            writer.write_table(whole.cast(schema))
            rows += whole.num_rows
    return rows


def _tables(
    bag: BagReader, name: str, lists_as_text: bool = False
) -> Iterator[pa.Table]:
    for columns in _batches(bag, name):
        try:
            table = pa.Table.from_pydict(columns)
        except (pa.ArrowException, ArithmeticError, TypeError, ValueError) as error:
            at_ns = columns["log_time_ns"][0]
            raise _unreadable(bag, name, at_ns, error) from None
        yield _without_lists(table) if lists_as_text else table


def _without_lists(table: pa.Table) -> pa.Table:
    """Return a table with lists as JSON text: CSV has none."""
    for i, column in enumerate(table.columns):
        if pa.types.is_list(column.type):
            texts = pa.array([json.dumps(value.as_py()) for value in column])
            table = table.set_column(i, table.column_names[i], texts)
    return table


def _batches(bag: BagReader, name: str) -> Iterator[dict[str, list[Any]]]:
    rows: list[Row] = []
    size = 0
    row_of = row_maker(bag.topics[name])
    for message in bag.messages([name]):
        try:
            row = row_of(message.data)
        except Exception as error:  # bytes that are not of the type fail anyhow
            raise _unreadable(bag, name, message.log_ns, error) from None
        rows.append({"log_time_ns": message.log_ns, **row})
        size += len(message.data)
        if len(rows) == _ROWS_PER_BATCH or size > _BYTES_PER_BATCH:
            yield _by_column(rows)
            rows, size = [], 0
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
