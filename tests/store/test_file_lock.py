from __future__ import annotations

import threading
from pathlib import Path

import pytest

from drivora_service.errors import Conflict
from drivora_service.store.file_lock import FileLock, is_locked


def test_looking_at_a_lock_never_keeps_it_from_being_taken(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    FileLock(path, refusal=str).release()
    done = threading.Event()

    def look() -> None:
        while not done.is_set():
            is_locked(path)

    looking = threading.Thread(target=look)
    looking.start()
    try:
        for _ in range(3000):
            FileLock(path, refusal=str).release()
    finally:
        done.set()
        looking.join()


def test_a_lock_that_is_held_is_seen_and_refused_and_names_its_holder(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    lock = FileLock(path, refusal=str)
    assert is_locked(path)
    with pytest.raises(Conflict, match=r"\d+"):
        FileLock(path, refusal=lambda holder: holder)
    lock.release()
    assert not is_locked(path)
    assert path.read_text().isdecimal()
