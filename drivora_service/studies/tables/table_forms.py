"""Tables in the forms that clients ask for: CSV, Parquet, an Arrow stream, JSON by column."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from drivora_service.errors import InvalidDocument, Problem, UnknownName
from drivora_service.observations.trace_files.table_stream import PartsFile
from drivora_service.studies.table_names import TableForm
from drivora_service.studies.tables.csv_text import csv_lines

_ROW_GROUP = 20_000
"""Rows that are written together."""
_MOST_JSON_ROWS = 100_000
"""Of a table as JSON, which is in memory as a whole."""

_FILE_PAGE = 2000
"""Rows of a file that are in memory at once."""

Row = dict[str, Any]
"""Values of a row by column."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table that is read page by page.

    Attributes:
        schema: Its columns.
        pages: Begins to read it; each row has a value for every column, and maybe more values.
    """

    schema: pa.Schema
    pages: Callable[[], Iterator[Sequence[Row]]]


def select_columns(table: Table, columns: Sequence[str]) -> Table:
    """Returns a table with some of its columns, in the wanted order; empty: all.

    Raises:
        UnknownName: It has no such column.
    """
    if not columns:
        return table
    for name in columns:
        if name not in table.schema.names:
            raise UnknownName("column", name, tuple(table.schema.names))
    wanted = dict.fromkeys(columns)
    return Table(schema=pa.schema([table.schema.field(name) for name in wanted]), pages=table.pages)


def table_of_file(path: Path) -> Table:
    """Returns the table in a Parquet file, such as one that :func:`table_chunks` made."""

    def pages() -> Iterator[Sequence[Row]]:
        with pq.ParquetFile(path) as file:
            for batch in file.iter_batches(_FILE_PAGE):
                yield batch.to_pylist()

    return Table(schema=pq.read_schema(path), pages=pages)


def table_chunks(table: Table, form: TableForm) -> Iterator[bytes]:
    """Yields a table as the parts of a file.

    Raises:
        InvalidDocument: It has too many rows for JSON.
    """
    match form:
        case TableForm.PARQUET:
            return _parquet(table)
        case TableForm.ARROW:
            return _arrow(table)
        case TableForm.JSON:
            return iter([_json(table)])
        case TableForm.CSV:
            return _csv(table)


def _parquet(table: Table) -> Iterator[bytes]:
    sink = PartsFile()
    with pq.ParquetWriter(sink, table.schema, compression="zstd") as writer:
        for rows in _groups(table):
            writer.write_table(pa.Table.from_pylist(rows, schema=table.schema))
            yield sink.take()
    yield sink.take()


def _arrow(table: Table) -> Iterator[bytes]:
    sink = PartsFile()
    with pa.ipc.new_stream(pa.PythonFile(sink, mode="w"), table.schema) as writer:
        for rows in table.pages():
            writer.write_table(pa.Table.from_pylist(list(rows), schema=table.schema))
            yield sink.take()
    yield sink.take()


def _csv(table: Table) -> Iterator[bytes]:
    columns = table.schema.names
    yield _lines([columns])
    for rows in table.pages():
        yield _lines([[_cell(row[column]) for column in columns] for row in rows])


def _json(table: Table) -> bytes:
    columns: dict[str, list[Any]] = {name: [] for name in table.schema.names}
    count = 0
    for rows in table.pages():
        count += len(rows)
        if count > _MOST_JSON_ROWS:
            message = f"found more than {_MOST_JSON_ROWS} rows; ask for Arrow or Parquet, or filter"
            raise InvalidDocument((Problem(pointer="", code="too_many_rows", message=message),))
        for name, values in columns.items():
            values += [row[name] for row in rows]
    return json.dumps({"rows": count, "columns": columns}, default=str).encode()


def _groups(table: Table) -> Iterator[list[Row]]:
    waiting: list[Row] = []
    for rows in table.pages():
        waiting += rows
        if len(waiting) >= _ROW_GROUP:
            yield waiting
            waiting = []
    if waiting:
        yield waiting


def _lines(rows: Sequence[Sequence[object]]) -> bytes:
    return csv_lines(rows).encode()


def _cell(value: object) -> object:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime):
        return value.isoformat(timespec="microseconds").replace("+00:00", "Z")
    return " ".join(map(str, value)) if isinstance(value, list) else value
