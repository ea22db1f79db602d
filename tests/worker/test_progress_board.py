"""The board is read as a file: no change of it stops the reader."""

from __future__ import annotations

import os
import sys

import pytest

from drivora_service.simulation.run_phase import RunPhase
from drivora_service.worker.progress_board import NO_PROGRESS, BoardReader, Progress, ProgressBoard


def test_what_is_written_is_read() -> None:
    reader = BoardReader()
    board = ProgressBoard(reader.fileno())
    assert reader.read() == NO_PROGRESS
    board.cells[:] = [RunPhase.IN_AGENT, 17, 2, 5, 1]
    assert reader.read() == Progress(
        phase=RunPhase.IN_AGENT, step=17, ego=2, run_counter=5, in_process=True
    )
    reader.close()
    assert reader.read() == NO_PROGRESS


def test_values_are_checked() -> None:
    reader = BoardReader()
    ProgressBoard(reader.fileno()).cells[:] = [99, 2**62, -(2**62), 2**31, 0]
    largest = 2**31 - 1
    assert reader.read() == Progress(
        phase=RunPhase.IDLE, step=largest, ego=-largest, run_counter=largest
    )
    reader.close()


@pytest.mark.skipif(sys.platform != "linux", reason="files are sealed on Linux only")
def test_it_cannot_be_made_smaller() -> None:
    reader = BoardReader()
    with pytest.raises(PermissionError):
        os.ftruncate(reader.fileno(), 0)
    reader.close()


def test_a_note_replaces_the_one_before_and_leaves_the_cells() -> None:
    reader = BoardReader()
    board = ProgressBoard(reader.fileno())
    board.cells[:] = [RunPhase.SIMULATING, 17, 2, 5, 1]
    before = reader.read()
    assert reader.note(100) == b""
    for note in (b"a long one", b"short", b"x" * 100_000):
        board.leave(note)
        assert reader.note(100_000) == note
    assert reader.read() == before
    reader.close()
    assert reader.note(100) == b""


def test_a_note_that_is_too_long_is_not_read() -> None:
    reader = BoardReader()
    ProgressBoard(reader.fileno()).leave(b"x" * 101)
    assert reader.note(100) == b""
    os.pwrite(reader.fileno(), b"\xff" * 8, 40)
    assert reader.note(1 << 40) == b""
    reader.close()


def test_where_its_size_can_be_changed_the_reader_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "other")
    reader = BoardReader()
    ProgressBoard(reader.fileno()).cells[:] = [RunPhase.SIMULATING, 1, 1, 1, 1]
    assert reader.read().phase is RunPhase.SIMULATING
    os.ftruncate(reader.fileno(), 3)
    assert reader.read() == NO_PROGRESS
    reader.close()
