"""The columns of a trace as an Arrow stream, for readers that take them as typed arrays.

The rows and columns are those of the trace file (``trace_file``), but no column holds nulls:
missing floats are NaN, ``lane`` is -1, ``light`` 0, and lists are empty. Buffers are not
compressed. The metadata of the schema is that of the file: one JSON document under
``drivora_trace``. Record batches hold whole steps, ``STEPS_OF_BATCH`` each.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from drivora_service.errors import StoreError, UnknownName
from drivora_service.observations.trace_files.table_stream import TableStream
from drivora_service.observations.trace_files.trace_file import (
    DAMAGE,
    METADATA_KEY,
    read_header,
    row_groups,
)
from drivora_service.observations.trace_files.trace_rows import TraceRows

STEPS_OF_BATCH = 256
_KEYS = ("step", "actor")
_MISSING = {pa.int32(): -1, pa.uint8(): 0}
"""What stands for null in columns of integers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TracePart:
    """The part of a trace that is wanted.

    Attributes:
        first: First step.
        stop: The step after the last one.
        rows: Whose rows.
        columns: Names of columns besides ``step`` and ``actor``; empty: all.
    """

    first: int = 0
    stop: int = 2**31 - 1
    rows: TraceRows = TraceRows.ALL
    columns: tuple[str, ...] = ()


def open_stream(path: Path, part: TracePart) -> TableStream:
    """Opens a trace file as a stream of record batches.

    Raises:
        UnknownName: The trace has no such column.
        StoreError: The file is missing, damaged or not a trace; also raised by the batches.
    """
    try:
        file = pq.ParquetFile(path, page_checksum_verification=True)
        header = read_header(file, path)
        egos = len(header["egos"])
        names = file.schema_arrow.names
    except FileNotFoundError as error:
        raise StoreError(f"there is no trace {path.name}") from error
    except DAMAGE as error:
        raise _make_error(path, error) from error
    for name in part.columns:
        if name not in names:
            file.close()
            raise UnknownName("column", name, tuple(names))
    chosen = [name for name in names if not part.columns or name in (*_KEYS, *part.columns)]
    schema = pa.schema(
        [pa.field(name, file.schema_arrow.field(name).type, nullable=False) for name in chosen],
        metadata={METADATA_KEY: file.schema_arrow.metadata[METADATA_KEY]},
    )
    return TableStream(schema=schema, batches=_batches(file, path, schema, part, egos))


def _batches(
    file: pq.ParquetFile, path: Path, schema: pa.Schema, part: TracePart, egos: int
) -> Iterator[pa.RecordBatch]:
    """Reads row group by row group; a step that continues in the next one waits for it."""
    waiting: pa.Table | None = None
    try:
        with file:
            groups = row_groups(file.metadata, (part.first, part.stop))
            for group in groups:
                table = file.read_row_group(group, columns=schema.names, use_threads=False)
                table = _select_rows(table, part, egos)
                if waiting is not None:
                    table = pa.concat_tables((waiting, table))
                steps = table.column("step").to_numpy()
                ends = _ends(steps, is_last=group == groups[-1])
                start = 0
                for end in ends:
                    yield _batch(table.slice(start, end - start), schema)
                    start = end
                waiting = table.slice(start)
    except DAMAGE as error:
        raise _make_error(path, error) from error


def _select_rows(table: pa.Table, part: TracePart, egos: int) -> pa.Table:
    steps = table.column("step").to_numpy()
    low, high = np.searchsorted(steps, (part.first, part.stop))
    table = table.slice(low, high - low)
    if part.rows is TraceRows.EGOS:
        table = table.filter(pa.array(table.column("actor").to_numpy() < egos))
    return table


def _ends(steps: NDArray[Any], *, is_last: bool) -> Sequence[int]:
    """Returns the rows behind each batch of whole steps; the last step of a group may go on."""
    if not len(steps):
        return ()
    last = int(steps[-1]) + is_last
    bounds = np.arange(int(steps[0]) + STEPS_OF_BATCH, last + STEPS_OF_BATCH, STEPS_OF_BATCH)
    bounds = bounds[bounds <= last] if not is_last else bounds
    ends: list[int] = np.searchsorted(steps, bounds).tolist()
    return ends


def _batch(table: pa.Table, schema: pa.Schema) -> pa.RecordBatch:
    columns = [_plain(table.column(field.name), field.type) for field in schema]
    return pa.RecordBatch.from_arrays(columns, schema=schema)


def _plain(column: pa.ChunkedArray, kind: pa.DataType) -> pa.Array:
    """Returns a column without a bitmap of nulls; missing lists are empty."""
    if pa.types.is_list(kind):
        lengths = pc.list_value_length(column).fill_null(0).to_numpy()
        offsets = np.concatenate(([0], np.cumsum(lengths))).astype(np.int32)
        return pa.ListArray.from_arrays(
            pa.array(offsets), pc.list_flatten(column).combine_chunks(), type=kind
        )
    if column.null_count and kind in _MISSING:
        column = column.fill_null(_MISSING[kind])
    return pa.array(column.to_numpy(), type=kind, from_pandas=False)


def _make_error(path: Path, error: Exception) -> StoreError:
    return StoreError(f"the trace {path.name} is damaged: {error!r}; run it again")
