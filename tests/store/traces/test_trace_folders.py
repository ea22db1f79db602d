"""The places of traces: what holds of folders, and of storages of other machines."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import fsspec
import pytest
from fsspec.implementations.local import LocalFileSystem

from drivora_service.errors import ConfigurationError, StoreError
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.observations.trace_files.trace_storage import remove_stored, store_trace
from drivora_service.store.traces import trace_copies
from drivora_service.store.traces.trace_folders import run_ids
from drivora_service.store.traces.trace_places import TracePlaces
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.object_storage import BUCKET, object_storage

TRACE = make_trace([SyntheticEgo(motion=Motion.along([0.0, 1.0, 2.0, 3.0], 0.0))])
OTHER = make_trace([SyntheticEgo(motion=Motion.along([0.0, 1.5, 3.0, 4.5], 0.0))])


@pytest.fixture(scope="module")
def storage() -> Iterator[dict[str, str]]:
    with object_storage() as environment:
        yield environment


@pytest.fixture(params=["folder", "file system", pytest.param("objects", marks=pytest.mark.slow)])
def places(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> TracePlaces:
    """Each kind of place, with nothing in it."""
    url = ""
    if request.param == "file system":
        url = f"file://{tmp_path / 'remote'}"
    elif request.param == "objects":
        for name, value in request.getfixturevalue("storage").items():
            monkeypatch.setenv(name, value)
        fsspec.config.set_conf_env(fsspec.config.conf)
        monkeypatch.setattr(fsspec.config, "conf", dict(fsspec.config.conf))
        url = f"s3://{BUCKET}/{tmp_path.name}"
    return TracePlaces(
        runs=tmp_path / "traces",
        campaigns=tmp_path / "campaigns",
        url=url,
        copies=tmp_path / "copies",
    )


def test_a_stored_trace_is_read_listed_and_removed(places: TracePlaces) -> None:
    traces = places.of_runs()
    assert not traces.path("01ab").is_file()
    assert list(run_ids(traces)) == []
    begun = time.time()
    for run_id, trace in (("01ab", TRACE), ("02ab", OTHER), ("01cd", TRACE)):
        store_trace(trace, traces.prepare(run_id))
    assert traces.path("01ab").is_file()
    assert trace_sha256(read_trace(traces.path("02ab"))) == trace_sha256(OTHER)
    assert traces.path("02ab").name == "02ab.parquet"
    assert list(traces.run_ids_by_folder()) == [("01ab", "02ab"), ("01cd",)]
    assert begun - 2.0 < traces.modification_time("01ab") < time.time() + 2.0
    size = traces.path("01ab").stat().st_size
    assert traces.remove("01ab") == size
    assert not traces.path("01ab").is_file()
    for refused in (traces.remove, traces.modification_time):
        with pytest.raises(FileNotFoundError):
            refused("01ab")
    remove_stored(traces.address("02ab"))
    remove_stored(traces.address("02ab"))
    assert list(run_ids(traces)) == ["01cd"]


def test_what_is_written_again_is_read_anew(places: TracePlaces) -> None:
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab"))
    assert trace_sha256(read_trace(traces.path("01ab"))) == trace_sha256(TRACE)
    # Storages tell whole seconds.
    time.sleep(1.1)
    store_trace(OTHER, traces.prepare("01ab"))
    assert trace_sha256(read_trace(traces.path("01ab"))) == trace_sha256(OTHER)


def test_a_copy_has_the_time_at_which_its_trace_was_written(tmp_path: Path) -> None:
    """It is part of the message on a damaged one."""
    places = TracePlaces(
        runs=tmp_path / "traces",
        campaigns=tmp_path / "campaigns",
        url=f"file://{tmp_path / 'remote'}",
        copies=tmp_path / "copies",
    )
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab"))
    (file,) = (tmp_path / "remote").rglob("*.parquet")
    os.utime(file, (0.0, 1000.0))
    copy = traces.path("01ab")
    assert copy.is_relative_to(tmp_path / "copies")
    assert copy.stat().st_mtime == 1000.0
    assert traces.path("02cd").name == "02cd.parquet", "messages name the file that is missing"


def test_each_attempt_has_its_own_trace(places: TracePlaces) -> None:
    traces = places.of_runs()
    first, third = traces.prepare("01ab"), traces.prepare("01ab", 3)
    store_trace(OTHER, third)
    # Of a worker that was taken for dead, and of a server that hung before it prepared.
    store_trace(TRACE, first)
    store_trace(TRACE, traces.address("01ab", 2))
    assert traces.prepare("01ab") == first
    assert trace_sha256(read_trace(traces.path("01ab", 3))) == trace_sha256(OTHER)
    assert traces.path("01ab", 3).name == "01ab.parquet"
    assert traces.modification_time("01ab") > 0.0
    assert list(run_ids(traces)) == ["01ab"]
    store_trace(TRACE, traces.prepare("02ab"))
    store_trace(TRACE, first)
    assert list(traces.run_ids_by_folder()) == [("01ab", "02ab")]
    failures = places.of_failures()
    failures.take(traces.address("01ab", 3), failures.address("camp", "1.trace.parquet"))
    kept = read_trace(failures.path("camp", "1.trace.parquet"))
    assert trace_sha256(kept) == trace_sha256(OTHER)
    size = traces.path("01ab", 3).stat().st_size
    assert traces.remove("01ab") > 2 * size
    for attempt in (1, 2, 3):
        assert not traces.path("01ab", attempt).is_file()
    with pytest.raises(FileNotFoundError):
        traces.remove("01ab")
    assert list(run_ids(traces)) == ["02ab"]
    if not places.url.startswith("s3:"):
        assert list(places.runs.parent.rglob("01ab")) == []


def test_of_earlier_versions_the_trace_is_found_whatever_the_attempt(places: TracePlaces) -> None:
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab"))
    assert trace_sha256(read_trace(traces.path("01ab", 2))) == trace_sha256(TRACE)
    # A database that was restored beside newer traces counts its attempts anew.
    store_trace(OTHER, traces.prepare("01ab", 2))
    store_trace(TRACE, traces.prepare("01ab", 1))
    assert trace_sha256(read_trace(traces.path("01ab", 1))) == trace_sha256(TRACE)


def test_a_trace_of_a_later_attempt_alone_is_listed_and_removed(places: TracePlaces) -> None:
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab", 12))
    assert list(run_ids(traces)) == ["01ab"]
    assert traces.remove("01ab") > 0
    assert list(run_ids(traces)) == []


def test_an_attempt_begins_without_the_traces_of_those_before(tmp_path: Path) -> None:
    traces = TracePlaces.below(tmp_path).of_runs()
    for attempt in (1, 2):
        store_trace(TRACE, traces.prepare("01ab", attempt))
    address = traces.prepare("01ab", 3)
    assert list(tmp_path.rglob("*.parquet")) == []
    assert [path.name for path in Path(address).parents[1].iterdir()] == ["3"]


def test_an_error_of_the_storage_is_told_and_nothing_is_taken_for_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "remote").mkdir()
    places = replace(TracePlaces.below(tmp_path), url=f"file://{tmp_path / 'remote'}")
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab", 2))

    def refuse(*_: object, **__: object) -> None:
        raise TimeoutError

    monkeypatch.setattr(LocalFileSystem, "ls", refuse)
    with pytest.raises(TimeoutError):
        traces.remove("01ab")
    monkeypatch.undo()
    assert traces.path("01ab", 2).is_file()


def test_what_another_process_writes_into_a_listed_folder_is_found(places: TracePlaces) -> None:
    traces = places.of_runs()
    store_trace(TRACE, traces.prepare("01ab"))
    assert list(run_ids(traces)) == ["01ab"]
    code = (
        "import sys; from tests.store.traces.test_trace_folders import OTHER, store_trace; "
        "store_trace(OTHER, sys.argv[1])"
    )
    subprocess.run(
        [sys.executable, "-c", code, traces.prepare("02ab")],
        cwd=Path(__file__).resolve().parents[3],
        check=True,
    )
    assert traces.path("02ab").is_file()
    assert trace_sha256(read_trace(traces.path("02ab"))) == trace_sha256(OTHER)
    assert list(run_ids(traces)) == ["01ab", "02ab"]


def test_a_failure_takes_the_trace_of_its_run(places: TracePlaces) -> None:
    traces, failures = places.of_runs(), places.of_failures()
    store_trace(TRACE, traces.prepare("01ab"))
    address = failures.address("camp", "3.trace.parquet")
    failures.take(traces.address("01ab"), address)
    failures.take(traces.address("gone"), failures.address("camp", "4.trace.parquet"))
    store_trace(OTHER, failures.address("camp", "5.trace.parquet"))
    assert failures.names("camp") == ("3.trace.parquet", "5.trace.parquet")
    assert failures.names("other") == ()
    traces.remove("01ab")
    kept = read_trace(failures.path("camp", "3.trace.parquet"))
    assert trace_sha256(kept) == trace_sha256(TRACE)
    assert failures.remove("camp", "3.trace.parquet") > 1000
    assert failures.names("camp") == ("5.trace.parquet",)


def test_the_probe_of_a_storage_leaves_nothing(places: TracePlaces) -> None:
    probe = places.storage_probe()
    if probe is None:
        assert places.url == ""
        return
    if places.url.startswith("file://"):
        with pytest.raises(OSError, match="nothing can be written to file://"):
            probe()
        return
    probe()
    assert list(run_ids(places.of_runs())) == []


def test_a_trace_that_cannot_be_written_is_an_error_of_the_store(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(StoreError, match="cannot write the trace file://"):
        store_trace(TRACE, f"file://{tmp_path}/taken/traces/a.parquet")


def test_unknown_storages_are_refused(tmp_path: Path) -> None:
    places = TracePlaces(
        runs=tmp_path, campaigns=tmp_path, url="nowhere://a/b", copies=tmp_path / "copies"
    )
    with pytest.raises(ConfigurationError, match="'nowhere' cannot be used"):
        places.of_runs()


def test_only_the_newest_copies_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trace_copies, "MOST_COPIES", 4)
    copies = tmp_path / "copies"
    places = TracePlaces(
        runs=tmp_path, campaigns=tmp_path, url=f"file://{tmp_path / 'remote'}", copies=copies
    )
    traces = places.of_runs()
    for number in range(9):
        store_trace(TRACE, traces.prepare(f"run-{number}"))
        assert traces.path(f"run-{number}").is_file()
        assert len(list(copies.iterdir())) <= 4
