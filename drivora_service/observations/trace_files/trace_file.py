"""The trace as a Parquet file: one row for each step and actor, static data in its metadata.

An actor has a row at each step at which it is present; an ego has one at every step. Columns:
``step``, ``time`` (s), ``actor`` (row in ``Trace.actors``), the nine of ``Col`` in lower case
(metres, radians, seconds; null while an ego is not present), the eight of ``EgoCol`` as
``ego_…``, ``lane`` (index in the network), ``light`` (``Light``), and ``log:NAME`` for each numeric
column of the agents' logs, and ``plan`` (x, y, x, y, …, metres) if an agent told its planned path.
Ego columns are null for other actors and where not applicable. The
schema's key-value metadata holds one JSON document under ``drivora_trace``.
"""

from __future__ import annotations

import contextlib
import json
import uuid
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from drivora_service.errors import StoreError
from drivora_service.observations.trace import Col, EgoCol, PlannedPath, Trace
from drivora_service.observations.trace_files.trace_header import header_of, trace_from_header

SCHEMA_VERSION = 1
METADATA_KEY = b"drivora_trace"
"""Of the JSON document in the metadata of the schema."""
_ROW_GROUP_ROWS = 32_768
_STATE_COLUMNS = tuple(col.name.lower() for col in Col)
_EGO_COLUMNS = tuple(f"ego_{col.name.lower()}" for col in EgoCol)
_LOG_PREFIX = "log:"
_PLAN = "plan"
DAMAGE = (
    *(OSError, pa.ArrowException, LookupError, TypeError, ValueError, AttributeError),
    *(ArithmeticError, RecursionError),
)
"""The errors of reading a file with arbitrary content."""


def write_trace(trace: Trace, path: Path) -> None:
    """Writes a trace; the replacement of ``path`` is atomic.

    Raises:
        StoreError: The file cannot be written, or ``meta`` is not JSON-able.
    """
    try:
        header = json.dumps({"schema_version": SCHEMA_VERSION, **header_of(trace)})
    except (TypeError, ValueError) as error:
        raise StoreError(f"the meta data of a trace must be JSON: {error}") from error
    table = _table(trace).replace_schema_metadata({METADATA_KEY: header.encode()})
    # Of this writer alone: a run may be under way twice, in containers with equal process ids.
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(
            table,
            partial,
            compression="lz4",
            use_dictionary=False,
            use_byte_stream_split=[
                field.name for field in table.schema if pa.types.is_float64(field.type)
            ],
            write_statistics=["step"],
            # LZ4 finds no flipped bits, and planned paths have no part in the hash of a trace.
            write_page_checksum=True,
            row_group_size=_ROW_GROUP_ROWS,
        )
        partial.replace(path)
    except OSError as error:
        raise StoreError(f"cannot write the trace {path.name}: {error}") from error
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)


def read_trace(path: Path) -> Trace:
    """Reads a trace that ``write_trace`` wrote; both have the same hash.

    Raises:
        StoreError: The file is missing, damaged, not a trace, or of another schema version.
    """
    return _read(path, None)


def read_steps(path: Path, first: int, last: int) -> Trace:
    """Reads rows ``first`` to ``last`` (exclusive) of a trace, as far as it has them.

    Row numbers stay those of the whole run: outside the range no actor is present, and times are
    NaN.

    Raises:
        StoreError: As ``read_trace``.
    """
    return _read(path, (first, last))


def _table(trace: Trace) -> pa.Table:
    """Returns the rows in order of step, then actor."""
    egos = trace.ego_count
    written = trace.present.copy()
    written[:, :egos] = True
    step, actor = np.nonzero(written)
    present = trace.present[written]
    is_ego = actor < egos
    ego_step, ego = step[is_ego], actor[is_ego]

    columns: dict[str, pa.Array] = {
        "step": _column(step.astype(np.int32), None),
        "time": _column(trace.times[step], None),
        "actor": _column(actor.astype(np.int16), None),
    }
    states = np.ascontiguousarray(trace.states[written].T, dtype=np.float64)
    valid = None if present.all() else present
    for name, column in zip(_STATE_COLUMNS, states, strict=True):
        columns[name] = _column(column, valid)

    def spread(values: NDArray[Any], known: NDArray[np.bool_]) -> pa.Array:
        column = np.zeros(len(step), dtype=values.dtype)
        column[is_ego] = values
        valid = np.zeros(len(step), dtype=np.bool_)
        valid[is_ego] = known
        return _column(column, valid)

    for name, column in zip(_EGO_COLUMNS, trace.ego_values[ego_step, ego].T, strict=True):
        columns[name] = spread(column, ~np.isnan(column))
    lanes = trace.ego_lanes[ego_step, ego].astype(np.int32)
    columns["lane"] = spread(lanes, lanes >= 0)
    lights = trace.ego_lights[ego_step, ego].astype(np.uint8)
    columns["light"] = spread(lights, np.ones(len(lights), dtype=np.bool_))
    logs = trace.log_values[ego_step, ego]
    for name, column in zip(trace.log_names, logs.T, strict=True):
        columns[_LOG_PREFIX + name] = spread(column, ~np.isnan(column))
    if trace.plans:
        columns[_PLAN] = _plan_column(trace, step, actor)
    return pa.table(columns)


def _plan_column(trace: Trace, step: NDArray[np.int64], actor: NDArray[np.int64]) -> pa.Array:
    """Returns the planned paths as lists of numbers, null in rows without one."""
    width = len(trace.actors)
    rows = np.searchsorted(
        step * width + actor, [path.step * width + path.ego for path in trace.plans]
    )
    counts, known = np.zeros(len(step), dtype=np.int32), np.zeros(len(step), dtype=np.bool_)
    counts[rows], known[rows] = [path.points.size for path in trace.plans], True
    offsets = np.concatenate(([0], np.cumsum(counts))).astype(np.int32)
    points = np.concatenate([path.points.ravel() for path in trace.plans])
    bitmap = pa.py_buffer(np.packbits(known, bitorder="little"))
    values = pa.array(points.astype(np.float32, copy=False))
    buffers = [bitmap, pa.py_buffer(offsets)]
    return pa.Array.from_buffers(pa.list_(pa.float32()), len(step), buffers, children=[values])


def _plans(table: pa.Table) -> tuple[PlannedPath, ...]:
    """Returns the planned paths in the rows of a file."""
    if _PLAN not in table.column_names:
        return ()
    table = table.filter(table.column(_PLAN).is_valid())
    steps, actors = (table.column(name).to_pylist() for name in ("step", "actor"))
    return tuple(
        PlannedPath(
            step=step, ego=ego, points=np.array(points.values, dtype=np.float32).reshape(-1, 2)
        )
        for step, ego, points in zip(steps, actors, table.column(_PLAN), strict=True)
    )


def _column(values: NDArray[Any], valid: NDArray[np.bool_] | None) -> pa.Array:
    """Wraps values without the copy that ``pa.array`` makes if some are null."""
    bitmap = None if valid is None else pa.py_buffer(np.packbits(valid, bitorder="little"))
    data = pa.py_buffer(np.ascontiguousarray(values))
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [bitmap, data])


def _read(path: Path, steps: tuple[int, int] | None) -> Trace:
    try:
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            header = read_header(file, path)
            groups = row_groups(file.metadata, steps)
            table = file.read_row_groups(groups, use_threads=False)
            rows = file.metadata.num_rows
        return _trace(header, table, rows, steps)
    except FileNotFoundError as error:
        raise StoreError(f"there is no trace {path.name}") from error
    except DAMAGE as error:
        raise StoreError(f"the trace {path.name} is damaged: {error!r}; run it again") from error


def read_header(file: pq.ParquetFile, path: Path) -> dict[str, Any]:
    """Returns the static part of a trace file (``header_of``), checked for its version.

    Raises:
        StoreError: The file is not a trace, or one of another schema version.
    """
    text = (file.schema_arrow.metadata or {}).get(METADATA_KEY)
    if text is None:
        raise StoreError(f"{path.name} is a Parquet file, but not a trace of Drivora")
    header: dict[str, Any] = json.loads(text)
    version = header["schema_version"]
    if version != SCHEMA_VERSION:
        raise StoreError(
            f"the trace {path.name} has version {version} of the trace file; "
            f"this release reads version {SCHEMA_VERSION}"
        )
    return header


def row_groups(metadata: pq.FileMetaData, steps: tuple[int, int] | None) -> list[int]:
    """Returns the row groups that hold any of the steps; all of them for ``None``."""
    groups = range(metadata.num_row_groups)
    if steps is None:
        return list(groups)
    chosen = []
    for group in groups:
        statistics = metadata.row_group(group).column(0).statistics
        if statistics.min < steps[1] and statistics.max >= steps[0]:
            chosen.append(group)
    return chosen


def _check_size(steps: int, egos: int, rows: int) -> None:
    """Checks the size in a header before memory is allocated for it.

    Raises:
        ValueError: The file lacks a row for an ego at a step.
    """
    if egos < 1 or not 0 <= steps * egos <= rows:
        raise ValueError(f"{steps} steps of {egos} egos do not fit into {rows} rows")


def _trace(
    header: dict[str, Any], table: pa.Table, rows: int, steps: tuple[int, int] | None
) -> Trace:
    """Puts the rows of a file back into arrays over (step, actor)."""
    count, actors, egos = int(header["steps"]), len(header["actors"]), len(header["egos"])
    _check_size(count, egos, rows)
    if steps is not None:
        numbers = table.column("step").to_numpy()
        low, high = np.searchsorted(numbers, steps)
        table = table.slice(low, high - low)
    step = table.column("step").to_numpy()
    actor = table.column("actor").to_numpy()
    times = np.full(count, np.nan)
    times[step] = table.column("time").to_numpy()

    states = np.full((count, actors, len(Col)), np.nan)
    for index, name in enumerate(_STATE_COLUMNS):
        states[step, actor, index] = table.column(name).to_numpy()
    present = np.zeros((count, actors), dtype=np.bool_)
    present[step, actor] = table.column(_STATE_COLUMNS[0]).is_valid().to_numpy()

    is_ego = actor < egos
    place = (step[is_ego], actor[is_ego])

    def gather(name: str) -> NDArray[np.float64]:
        column = np.full((count, egos), np.nan)
        column[place] = table.column(name).to_numpy()[is_ego]
        return column

    lanes, lights = gather("lane"), gather("light")
    log_names = header["logs"]["names"]
    return trace_from_header(
        header,
        times=times,
        states=states,
        present=present,
        ego_values=np.stack([gather(name) for name in _EGO_COLUMNS], axis=-1),
        ego_lanes=np.nan_to_num(lanes, nan=-1.0).astype(np.int32),
        ego_lights=np.nan_to_num(lights, nan=0.0).astype(np.uint8),
        plans=_plans(table),
        log_values=(
            np.stack([gather(_LOG_PREFIX + name) for name in log_names], axis=-1)
            if log_names
            else np.empty((count, egos, 0))
        ),
    )
