"""Recorded frames over HTTP: as lines of JSON, as Parquet or as Arrow, whole or a part."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING

from fastapi import Request, Response
from fastapi.responses import FileResponse, StreamingResponse

from drivora_service.api.answers.arrow_answer import ARROW, arrow_answer
from drivora_service.api.guards.entity_tags import cache_headers, digest, is_known
from drivora_service.api.guards.negotiation import accepted_form
from drivora_service.api.problem_details import ApiError
from drivora_service.observations.trace_files.trace_rows import TraceRows

if TYPE_CHECKING:
    from pathlib import Path

    from drivora_service.observations.trace_files.stored_trace import StoredTrace
    from drivora_service.observations.trace_files.table_stream import TableStream

NDJSON = "application/x-ndjson"
PARQUET = "application/vnd.apache.parquet"
CSV = "text/csv"

_FORMS = (NDJSON, PARQUET, ARROW)
_OTHER_NAMES = {
    "application/x-parquet": PARQUET,
    "application/ndjson": NDJSON,
    "application/jsonl": NDJSON,
}
_CHUNK_BYTES = 64 * 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRange:
    """Steps ``first`` to ``last``, both included; ``None``: to the end."""

    first: int
    last: int | None

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left out."""
        return self.first == 0 and self.last is None

    @property
    def stop(self) -> int:
        """The step behind the last one."""
        return 2**31 - 1 if self.last is None else self.last + 1


@dataclass(frozen=True, slots=True, kw_only=True)
class FramePart:
    """The part of a recording that a client wants.

    Attributes:
        steps: Range of steps.
        rows: Whose rows; of Arrow only.
        columns: Columns besides ``step`` and ``actor``, of Arrow only; empty: all.
    """

    steps: StepRange
    rows: TraceRows
    columns: tuple[str, ...]


def observations_answer(request: Request, stored: StoredTrace, part: FramePart) -> Response:
    """Answers with the recorded frames of a run in the form that the client accepts.

    The trace is checked before anything is sent.

    Raises:
        ApiError: The range is empty (422); or the client accepts none of the forms, of which a
            choice of columns or rows leaves Arrow (406).
        UnknownName: The trace has no such column.
        TraceDamaged: The file is not the trace that was recorded.
    """
    steps = part.steps
    if steps.last is not None and steps.last < steps.first:
        raise ApiError(HTTPStatus.UNPROCESSABLE_ENTITY, "`last` must not be before `first`")
    has_choice = part.columns or part.rows is not TraceRows.ALL
    form = accepted_form(request, (ARROW,) if has_choice else _FORMS, _OTHER_NAMES)
    if form == ARROW:
        return _arrow(request, stored, part)
    name = "parquet" if form == PARQUET else "ndjson"
    etag = f"{stored.sha256}-{name}-{steps.first}-{'' if steps.last is None else steps.last}"
    headers = cache_headers(etag)
    if is_known(request, etag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    from drivora_service.observations.trace_files.checked_trace import (
        check_trace,
        read_checked_trace,
    )

    if form == NDJSON:
        from drivora_service.observations.scene_obs import ndjson
        from drivora_service.observations.trace_files.trace_file import read_steps

        if steps.is_whole:
            trace = read_checked_trace(stored)
        else:
            check_trace(stored)
            trace = read_steps(stored.path, steps.first, steps.stop)
        lines = ndjson(trace, steps.first, steps.stop)
        return StreamingResponse(_chunks(lines), media_type=NDJSON, headers=headers)
    check_trace(stored)
    path = stored.path
    headers["Content-Disposition"] = f'attachment; filename="{path.name}"'
    if steps.is_whole:
        return FileResponse(path, media_type=PARQUET, headers=headers)
    return Response(_parquet_range(path, steps), media_type=PARQUET, headers=headers)


def _arrow(request: Request, stored: StoredTrace, part: FramePart) -> Response:
    from drivora_service.observations.trace_files.checked_trace import check_trace
    from drivora_service.observations.trace_files.trace_stream import TracePart, open_stream

    columns = ",".join(sorted(set(part.columns)))
    etag = digest(f"{stored.sha256} {part.steps} {part.rows} {columns}".encode())

    def open_part() -> TableStream:
        wanted = TracePart(
            first=part.steps.first, stop=part.steps.stop, rows=part.rows, columns=part.columns
        )
        check_trace(stored)
        return open_stream(stored.path, wanted)

    return arrow_answer(request, open_part, etag=etag)


def _parquet_range(path: Path, steps: StepRange) -> bytes:
    import pyarrow.parquet as pq

    wanted = [("step", ">=", steps.first), ("step", "<", steps.stop)]
    table = pq.read_table(path, filters=wanted, use_threads=False)
    buffer = io.BytesIO()
    pq.write_table(table, buffer)
    return buffer.getvalue()


def _chunks(lines: Iterator[bytes]) -> Iterator[bytes]:
    """Joins lines, as every chunk costs a switch of threads."""
    waiting: list[bytes] = []
    size = 0
    for line in lines:
        waiting.append(line)
        size += len(line)
        if size >= _CHUNK_BYTES:
            yield b"".join(waiting)
            waiting, size = [], 0
    if waiting:
        yield b"".join(waiting)
