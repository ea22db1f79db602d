"""Copies of trace files of a storage, which several threads use."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from drivora_service.store.traces import trace_copies
from drivora_service.store.traces.trace_copies import TraceCopies


def test_a_copy_may_be_made_while_old_ones_are_forgotten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trace_copies, "MOST_COPIES", 4)
    copies = TraceCopies(tmp_path / "copies")

    def make(name: str) -> Path:
        return copies.get(
            name, "", lambda part: Path(part).write_text(name), size=None, written=float("inf")
        )

    late = threading.Thread(target=make, args=("late.parquet",))
    exists = Path.exists

    def exists_after_another_copy(path: Path) -> bool:
        if late.ident is None:
            late.start()
            # It waits for its turn to forget, with its copy made.
            late.join(0.2)
        return exists(path)

    monkeypatch.setattr(Path, "exists", exists_after_another_copy)
    for number in range(5):
        assert make(f"{number}.parquet").name == f"{number}.parquet"
    assert late.ident is not None
    late.join()
    assert all(map(exists, copies._states))
    assert "late.parquet" in {path.name for path in copies._states}
