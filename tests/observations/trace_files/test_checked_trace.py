from __future__ import annotations

import contextlib
import os
import pickle
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from drivora_service.errors import TraceDamaged
from drivora_service.observations.trace import PlannedPath, Trace
from drivora_service.observations.trace_files import checked_trace
from drivora_service.observations.trace_files.checked_trace import check_trace, read_checked_trace
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from drivora_service.observations.trace_files.trace_file import read_trace, write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256


@pytest.fixture
def stored(full_trace: Trace, tmp_path: Path) -> StoredTrace:
    path = tmp_path / "01ab.parquet"
    write_trace(full_trace, path)
    return StoredTrace(run_id="01ab", path=path, sha256=trace_sha256(full_trace))


def make_other(trace: Trace) -> Trace:
    """Returns the trace of another run, of which a file has the same size."""
    states = trace.states.copy()
    states[5, 0, 0] += 1.0
    return replace(trace, states=states)


def damage(stored: StoredTrace) -> TraceDamaged:
    """Returns the error of a trace, which both ways of reading raise."""
    with pytest.raises(TraceDamaged) as checking:
        check_trace(stored)
    with pytest.raises(TraceDamaged) as reading:
        read_checked_trace(stored)
    assert str(checking.value) == str(reading.value)
    return checking.value


def test_the_recorded_trace_is_read(stored: StoredTrace, full_trace: Trace) -> None:
    check_trace(stored)
    assert trace_sha256(read_checked_trace(stored)) == trace_sha256(full_trace)


def test_another_trace_is_refused_with_both_hashes(stored: StoredTrace, full_trace: Trace) -> None:
    other = make_other(full_trace)
    write_trace(other, stored.path)
    os.utime(stored.path, (0.0, 86_400.0 * 365))
    error = damage(stored)
    assert (error.code, error.file) == ("trace_differs", str(stored.path))
    text = str(error)
    assert text.startswith("run 01ab: its trace file 01ab.parquet is damaged or of another run")
    assert f"it has the hash {trace_sha256(other)}" in text
    assert f"a trace with the hash {stored.sha256} was recorded" in text
    assert "last written at 1971-01-01 00:00:00 UTC" in text
    assert "`drivora replay 01ab`" in text
    assert str(stored.path.parent) not in text, "clients are not told where the file is"


def test_a_file_that_ends_early_and_none_at_all(stored: StoredTrace) -> None:
    stored.path.write_bytes(stored.path.read_bytes()[:-100])
    error = damage(stored)
    assert error.code == "trace_unreadable"
    assert "01ab.parquet cannot be read (" in str(error)
    assert stored.sha256 in str(error)
    stored.path.unlink()
    error = damage(stored)
    assert error.code == "trace_missing"
    assert f"is missing: a trace with the hash {stored.sha256} was recorded" in str(error)


def test_a_file_is_hashed_once_until_it_changes(
    stored: StoredTrace, full_trace: Trace, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    hashed = []

    def count(trace: Trace) -> str:
        hashed.append(trace)
        return trace_sha256(trace)

    monkeypatch.setattr(checked_trace, "trace_sha256", count)
    for _ in range(3):
        check_trace(stored)
        read_checked_trace(stored)
    assert len(hashed) == 1
    # Another expected hash is another question, whatever is known of the file.
    with pytest.raises(TraceDamaged):
        check_trace(replace(stored, sha256="0" * 64))
    # Of the same size and with the same time of modification, but another content.
    write_trace(make_other(full_trace), tmp_path / "other")
    before = stored.path.stat()
    assert (tmp_path / "other").stat().st_size == before.st_size
    with stored.path.open("r+b") as file:
        file.write((tmp_path / "other").read_bytes())
    os.utime(stored.path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert stored.path.stat().st_mtime_ns == before.st_mtime_ns
    assert damage(stored).code == "trace_differs"


def test_few_files_are_remembered(full_trace: Trace, stored: StoredTrace) -> None:
    known = checked_trace._KnownFiles(2)
    states = [
        checked_trace._state_of(
            replace(stored, path=Path(shutil.copy(stored.path, stored.path.with_name(name))))
        )
        for name in "abc"
    ]
    known.add(states[0])
    known.add(states[1])
    assert known.has(states[0])
    known.add(states[2])
    assert [known.has(state) for state in states] == [True, False, True]


def test_flipped_bits_are_found_in_what_has_no_part_in_the_hash(
    stored: StoredTrace, full_trace: Trace
) -> None:
    points = np.linspace(0.0, 50.0, 40, dtype=np.float32).reshape(-1, 2)
    planned = replace(full_trace, plans=(PlannedPath(step=3, ego=0, points=points),))
    assert trace_sha256(planned) == stored.sha256
    write_trace(planned, stored.path)
    read_checked_trace(stored)
    metadata = pq.ParquetFile(stored.path).metadata.row_group(0)
    places = [metadata.column(i) for i in range(metadata.num_columns)]
    (plan,) = (one for one in places if one.path_in_schema.startswith("plan"))
    content = bytearray(stored.path.read_bytes())
    content[plan.data_page_offset + plan.total_compressed_size - 8] ^= 1
    stored.path.write_bytes(content)
    assert damage(stored).code == "trace_unreadable"


def test_files_without_checksums_are_read(full_trace: Trace, stored: StoredTrace) -> None:
    """As earlier versions wrote them."""
    table = pq.read_table(stored.path)
    pq.write_table(table, stored.path, compression="lz4")
    assert trace_sha256(read_trace(stored.path)) == stored.sha256
    check_trace(stored)


def test_the_error_reaches_other_processes_whole() -> None:
    error = pickle.loads(pickle.dumps(TraceDamaged("text", code="trace_missing", file="a")))
    assert isinstance(error, TraceDamaged)
    assert (str(error), error.code, error.file) == ("text", "trace_missing", "a")


def make_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def make_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def link_itself(path: Path) -> None:
    path.unlink()
    path.symlink_to(path)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (make_folder, "it is a folder, not a file"),
        (make_pipe, "it is a pipe, a socket or a device, not a file"),
        (link_itself, "Too many levels of symbolic links"),
    ],
)
def test_what_is_no_file_is_said(
    stored: StoredTrace, change: Callable[[Path], None], told: str
) -> None:
    change(stored.path)
    error = damage(stored)
    assert error.code == "trace_unreadable"
    assert f"01ab.parquet cannot be read: {told}; a trace with the hash" in str(error)


@contextlib.contextmanager
def as_another_user() -> Iterator[None]:
    """Runs the rest of this process as a user without rights, if it runs as root."""
    if os.geteuid() == 0:
        os.seteuid(65534)
        try:
            yield
        finally:
            os.seteuid(0)
    else:
        yield


@pytest.mark.parametrize("which", ["file", "folder"])
def test_a_file_without_rights_is_not_missing(stored: StoredTrace, which: str) -> None:
    for folder in (stored.path.parent, stored.path.parent.parent):
        folder.chmod(0o755)
    closed = stored.path if which == "file" else stored.path.parent
    closed.chmod(0)
    try:
        with as_another_user():
            error = damage(stored)
    finally:
        closed.chmod(0o755)
    assert error.code == "trace_unreadable"
    assert "Permission denied" in str(error)


def test_a_link_to_the_right_trace_is_read(stored: StoredTrace, tmp_path: Path) -> None:
    """Operators move traces to another disk, and leave a link."""
    moved = tmp_path / "moved"
    shutil.move(stored.path, moved)
    stored.path.symlink_to(moved)
    check_trace(stored)
    moved.write_bytes(b"")
    assert damage(stored).code == "trace_unreadable"
