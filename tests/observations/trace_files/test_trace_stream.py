from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drivora_service.errors import StoreError, UnknownName
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.table_stream import stream_bytes
from drivora_service.observations.trace_files.trace_file import write_trace
from drivora_service.observations.trace_files.trace_rows import TraceRows
from drivora_service.observations.trace_files.trace_stream import (
    STEPS_OF_BATCH,
    TracePart,
    open_stream,
)
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace


@pytest.fixture
def path(full_trace: Trace, tmp_path: Path) -> Path:
    path = tmp_path / "run.parquet"
    write_trace(full_trace, path)
    return path


def read(path: Path, part: TracePart) -> pa.Table:
    """Reads a part as a client does: from the bytes."""
    content = b"".join(stream_bytes(open_stream(path, part)))
    return pa.ipc.open_stream(content).read_all()


def test_the_values_are_those_of_the_file_and_nothing_is_null(path: Path) -> None:
    file, stream = pq.read_table(path), read(path, TracePart())
    assert stream.column_names == file.column_names
    assert stream.num_rows == file.num_rows
    missing = {"lane": -1, "light": 0}
    for name in file.column_names:
        assert not stream.schema.field(name).nullable
        assert stream.schema.field(name).type == file.schema.field(name).type
        column = file.column(name)
        if column.null_count:
            column = column.fill_null(missing.get(name, np.nan))
        wanted = column.to_numpy()
        np.testing.assert_array_equal(stream.column(name).to_numpy(), wanted, strict=True)
    # The comparison would hold for columns without a missing value, too.
    assert file.column("x").null_count == 0
    assert file.column("lane").null_count > 0
    assert file.column("ego_light_distance").null_count > 0


def test_the_static_part_comes_with_the_schema(path: Path, full_trace: Trace) -> None:
    header = json.loads(read(path, TracePart()).schema.metadata[b"drivora_trace"])
    assert [actor["id"] for actor in header["actors"]] == [a.id for a in full_trace.actors]
    assert header["step_length"] == full_trace.step_length


def test_a_part_has_the_steps_actors_and_columns_that_are_wanted(path: Path) -> None:
    wanted = TracePart(first=8, stop=13, rows=TraceRows.EGOS, columns=("yaw", "x"))
    table = read(path, wanted)
    assert table.column_names == ["step", "actor", "x", "yaw"]
    assert table.column("step").to_pylist() == [s for s in range(8, 13) for _ in range(2)]
    assert set(table.column("actor").to_pylist()) == {0, 1}
    assert read(path, TracePart(first=10**6)).num_rows == 0


def test_batches_hold_whole_steps_where_a_step_continues_in_the_next_row_group(
    tmp_path: Path,
) -> None:
    steps = 3 * STEPS_OF_BATCH + 5
    others = [
        SyntheticActor(id=f"a{i}", motion=Motion.steady(9.0, 4.0 * i, steps=steps, speed=1.0))
        for i in range(46)
    ]
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=steps))], others)
    path = tmp_path / "long.parquet"
    write_trace(trace, path)
    with pq.ParquetFile(path) as file:
        assert file.num_row_groups > 1
        assert file.metadata.row_group(0).num_rows % 47
    batches = list(open_stream(path, TracePart(first=3)).batches)
    counts = [batch.num_rows / 47 for batch in batches]
    assert max(counts) == STEPS_OF_BATCH
    assert all(count.is_integer() for count in counts)
    found = pa.Table.from_batches(batches).column("step").to_numpy()
    np.testing.assert_array_equal(found, np.repeat(np.arange(3, steps), 47))


def test_an_unknown_column_and_a_damaged_file_are_named(path: Path) -> None:
    with pytest.raises(UnknownName, match=r"colour.*known: step, time"):
        open_stream(path, TracePart(columns=("x", "colour")))
    content = bytearray(path.read_bytes())
    content[200:4000] = bytes(3800)
    path.write_bytes(content)
    with pytest.raises(StoreError, match="damaged"):
        list(open_stream(path, TracePart()).batches)
    with pytest.raises(StoreError, match="no trace"):
        open_stream(path.with_name("none"), TracePart())
