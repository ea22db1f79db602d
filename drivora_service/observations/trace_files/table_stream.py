"""A table that is read while it is iterated over, and its bytes as an Arrow stream."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class TableStream:
    """Record batches of one schema.

    Attributes:
        schema: Of every batch.
        batches: In order; they may be none.
    """

    schema: pa.Schema
    batches: Iterator[pa.RecordBatch]


def stream_bytes(stream: TableStream) -> Iterator[bytes]:
    """Yields an Arrow IPC stream in parts: the schema, each batch, the end."""
    sink = PartsFile()
    with pa.ipc.new_stream(sink, stream.schema) as writer:
        for batch in stream.batches:
            yield sink.take()
            writer.write_batch(batch)
    yield sink.take()


class PartsFile:
    """A file in memory whose content is taken from it in parts."""

    def __init__(self) -> None:
        self.closed = False
        self._parts: list[bytes] = []

    def write(self, part: bytes) -> int:
        """Keeps a part until it is taken; returns its number of bytes."""
        self._parts.append(bytes(part))
        return len(part)

    def take(self) -> bytes:
        """Returns what was written since the last call."""
        taken = b"".join(self._parts)
        self._parts.clear()
        return taken

    def flush(self) -> None:
        """Does nothing: all is in memory."""

    def close(self) -> None:
        """Ends the file; what was written can still be taken."""
        self.closed = True


def one_batch(columns: Mapping[str, NDArray[Any]], metadata: Mapping[str, str]) -> TableStream:
    """Returns columns of numbers as a stream of one batch without nulls.

    Args:
        columns: (n,) values by name.
        metadata: Of the schema.
    """
    arrays = [pa.array(np.ascontiguousarray(values)) for values in columns.values()]
    schema = pa.schema(
        [
            pa.field(name, array.type, nullable=False)
            for name, array in zip(columns, arrays, strict=True)
        ],
        metadata=dict(metadata),
    )
    batch = pa.RecordBatch.from_arrays(arrays, schema=schema)
    return TableStream(schema=schema, batches=iter((batch,)))
