"""A table that is read while it is iterated over, and its bytes as an Arrow stream."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pyarrow as pa


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
        """Keeps a part."""
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
