from __future__ import annotations

import json
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drivora_service.errors import StoreError
from drivora_service.observations.trace import PlannedPath, Role, Trace
from drivora_service.observations.trace_files.table_stream import stream_bytes
from drivora_service.observations.trace_files.trace_file import read_steps, read_trace, write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.observations.trace_files.trace_rows import TraceRows
from drivora_service.observations.trace_files.trace_stream import TracePart, open_stream
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.observations.conftest import STEPS


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.parquet"


def test_what_is_read_is_what_was_written(full_trace: Trace, path: Path) -> None:
    write_trace(full_trace, path)
    found = read_trace(path)
    assert trace_sha256(found) == trace_sha256(full_trace)
    for field in fields(Trace):
        here, there = getattr(full_trace, field.name), getattr(found, field.name)
        if isinstance(here, np.ndarray):
            np.testing.assert_array_equal(there, here, strict=True)
        elif field.name != "ego_routes":
            assert there == here


def test_an_ego_that_left_the_world_keeps_its_values(full_trace: Trace, path: Path) -> None:
    present, states = full_trace.present.copy(), full_trace.states.copy()
    present[50:, 0] = False
    states[50:, 0] = np.nan
    gone = replace(full_trace, present=present, states=states)
    write_trace(gone, path)
    found = read_trace(path)
    assert trace_sha256(found) == trace_sha256(gone)
    assert not found.present[50:, 0].any()


def test_a_trace_of_one_row_without_others_lights_or_logs(path: Path) -> None:
    road = np.array([(0.0, 0.0), (1.0, 0.0)])
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=1), route=road)])
    write_trace(trace, path)
    assert trace_sha256(read_trace(path)) == trace_sha256(trace)


def test_the_columns_can_be_read_without_drivora(full_trace: Trace, path: Path) -> None:
    write_trace(full_trace, path)
    table = pq.read_table(path)
    rows = table.filter(pa.compute.equal(table["actor"], 2)).to_pydict()
    assert rows["step"] == np.flatnonzero(full_trace.present[:, 2]).tolist()
    assert rows["x"] == full_trace.states[full_trace.present[:, 2], 2, 0].tolist()
    assert set(rows["ego_route_s"]) == {None}
    header = json.loads(table.schema.metadata[b"drivora_trace"])
    assert header["actors"][2]["role"] == Role.NPC_VEHICLE
    assert header["lights"]["changes"]["junction"] == [[0, 0], [33, 1]]


def test_some_steps_are_those_of_the_whole(path: Path) -> None:
    # Enough actors that the file has several row groups.
    steps = 400
    others = [
        SyntheticActor(id=f"npc{i}", motion=Motion.steady(0.0, 4.0 * i, steps=steps, speed=5.0))
        for i in range(1, 200)
    ]
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=steps))], others)
    write_trace(trace, path)
    assert pq.ParquetFile(path).metadata.num_row_groups > 2
    part = read_steps(path, 170, 180)
    np.testing.assert_array_equal(part.states[170:180], trace.states[170:180])
    np.testing.assert_array_equal(part.times[170:180], trace.times[170:180])
    assert part.present[170:180].all()
    assert not np.delete(part.present, np.s_[170:180], axis=0).any()


def test_steps_beyond_the_end_are_empty(full_trace: Trace, path: Path) -> None:
    write_trace(full_trace, path)
    assert not read_steps(path, 1000, 2000).present.any()


def test_writing_replaces_and_leaves_nothing_beside(full_trace: Trace, path: Path) -> None:
    path.write_bytes(b"an older file")
    write_trace(full_trace, path)
    assert [file.name for file in path.parent.iterdir()] == [path.name]
    assert trace_sha256(read_trace(path)) == trace_sha256(full_trace)


def test_two_writers_of_one_trace_do_not_write_into_one_file(
    full_trace: Trace, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    both_have_written = threading.Barrier(2)
    write = pq.write_table

    def write_slowly(*arguments: Any, **options: Any) -> None:
        write(*arguments, **options)
        both_have_written.wait(30)

    monkeypatch.setattr(pq, "write_table", write_slowly)
    # As attempts of one run on two machines, whose processes have equal ids.
    with ThreadPoolExecutor(2) as pool:
        for writer in [pool.submit(write_trace, full_trace, path) for _ in range(2)]:
            writer.result()
    assert trace_sha256(read_trace(path)) == trace_sha256(full_trace)
    assert list(path.parent.iterdir()) == [path]


def test_meta_that_is_not_json_is_refused_before_anything_is_written(
    full_trace: Trace, path: Path
) -> None:
    with pytest.raises(StoreError, match="JSON"):
        write_trace(replace(full_trace, meta={"array": np.zeros(2)}), path)
    assert not path.exists()


def test_a_folder_that_is_not_there_is_made(full_trace: Trace, tmp_path: Path) -> None:
    write_trace(full_trace, tmp_path / "missing" / "run.parquet")
    assert read_trace(tmp_path / "missing" / "run.parquet").step_count == full_trace.step_count


def test_a_file_where_the_folder_belongs_is_a_store_error(
    full_trace: Trace, tmp_path: Path
) -> None:
    (tmp_path / "missing").write_text("in the way")
    with pytest.raises(StoreError, match="cannot write"):
        write_trace(full_trace, tmp_path / "missing" / "run.parquet")


def test_a_missing_file_is_a_store_error(path: Path) -> None:
    with pytest.raises(StoreError, match=r"no trace run\.parquet"):
        read_trace(path)


@pytest.mark.parametrize("keep", [0.0, 0.01, 0.5, 0.999])
def test_a_truncated_file_is_a_store_error(full_trace: Trace, path: Path, keep: float) -> None:
    write_trace(full_trace, path)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * keep)])
    with pytest.raises(StoreError, match=r"run\.parquet is damaged"):
        read_trace(path)


def test_another_parquet_file_is_a_store_error(path: Path) -> None:
    pq.write_table(pa.table({"step": [1]}), path)
    with pytest.raises(StoreError, match="not a trace"):
        read_trace(path)


def test_another_version_is_a_store_error(full_trace: Trace, path: Path) -> None:
    write_trace(full_trace, path)
    table = pq.read_table(path)
    header = json.loads(table.schema.metadata[b"drivora_trace"])
    text = json.dumps({**header, "schema_version": 99})
    pq.write_table(table.replace_schema_metadata({"drivora_trace": text}), path)
    with pytest.raises(StoreError, match="version 99"):
        read_trace(path)


def test_a_header_without_its_entries_is_a_store_error(full_trace: Trace, path: Path) -> None:
    write_trace(full_trace, path)
    table = pq.read_table(path)
    text = json.dumps({"schema_version": 1, "steps": 80})
    pq.write_table(table.replace_schema_metadata({"drivora_trace": text}), path)
    with pytest.raises(StoreError, match="damaged"):
        read_trace(path)


def test_planned_paths_are_kept_and_leave_the_hash_and_other_files_as_they_are(
    full_trace: Trace, path: Path
) -> None:
    write_trace(full_trace, path)
    assert "plan" not in pq.read_schema(path).names
    rng = np.random.default_rng(3)
    plans = tuple(
        PlannedPath(step=step, ego=ego, points=rng.normal(size=(n, 2)).astype(np.float32))
        for step, ego, n in ((0, 0, 2), (4, 0, 5), (4, 1, 3), (STEPS - 1, 1, 64))
    )
    planned = replace(full_trace, plans=plans)
    write_trace(planned, path)
    found = read_trace(path)
    assert trace_sha256(found) == trace_sha256(full_trace)
    assert [(p.step, p.ego) for p in found.plans] == [(p.step, p.ego) for p in plans]
    for there, here in zip(found.plans, plans, strict=True):
        np.testing.assert_array_equal(there.points, here.points, strict=True)
    assert [(p.step, p.ego) for p in read_steps(path, 3, 5).plans] == [(4, 0), (4, 1)]
    part = TracePart(first=3, stop=6, rows=TraceRows.EGOS, columns=("plan",))
    content = b"".join(stream_bytes(open_stream(path, part)))
    table = pa.ipc.open_stream(content).read_all()
    assert table.column("plan").null_count == 0
    rows = table.to_pydict()
    lengths = [len(points) for points in rows["plan"]]
    assert list(zip(rows["step"], rows["actor"], lengths, strict=True)) == [
        (3, 0, 0), (3, 1, 0), (4, 0, 10), (4, 1, 6), (5, 0, 0), (5, 1, 0)
    ]  # fmt: skip
    np.testing.assert_array_equal(rows["plan"][2], plans[1].points.ravel())
