"""Locks of files: their holders and their release."""

from __future__ import annotations

import errno
import fcntl
import os
import signal
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from drivora_service.errors import Conflict, StoreError
from drivora_service.store.locks.file_lock import FileLock, is_locked

OURS = """
from pathlib import Path
from drivora_service.store.locks.file_lock import FileLock
lock = FileLock(Path(sys.argv[1]), refusal=str)
"""
PLAIN = """
import fcntl, os
file = os.open(sys.argv[1], os.O_RDWR | os.O_CREAT, 0o600)
fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
os.ftruncate(file, 0)
os.write(file, str(os.getpid()).encode())
"""
"""How a file is locked without the library, as processes of earlier versions do."""


@contextmanager
def holder(path: Path, code: str) -> Iterator[subprocess.Popen[bytes]]:
    """Lets another process hold a lock; kills it in the end."""
    program = f"import sys, time\n{code}\nprint('held', flush=True); time.sleep(3600)"
    with subprocess.Popen(
        [sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"held\n"
        try:
            yield process
        finally:
            process.kill()


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


def test_processes_that_check_a_lock_do_not_count_as_holders(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    FileLock(path, refusal=str).release()
    seen: set[bool] = set()
    lookers = [
        threading.Thread(target=lambda: seen.update(is_locked(path) for _ in range(3000)))
        for _ in range(4)
    ]
    for looker in lookers:
        looker.start()
    for looker in lookers:
        looker.join()
    assert seen == {False}


def test_a_lock_that_is_held_is_seen_and_refused_and_names_its_holder(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    lock = FileLock(path, refusal=str)
    assert is_locked(path)
    for _ in range(2):
        with pytest.raises(Conflict, match=f"^{os.getpid()}$"):
            FileLock(path, refusal=lambda holder: holder)
    lock.release()
    assert not is_locked(path)
    assert path.read_text() == str(os.getpid())


@pytest.mark.parametrize("code", [OURS, PLAIN], ids=["ours", "plain"])
def test_the_lock_of_another_process_is_respected_until_it_is_killed(
    tmp_path: Path, code: str
) -> None:
    path = tmp_path / "lock"
    with holder(path, code) as process:
        assert is_locked(path)
        with pytest.raises(Conflict, match=f"^{process.pid}$"):
            FileLock(path, refusal=lambda holder: holder)
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert not is_locked(path)
        FileLock(path, refusal=str).release()


def test_a_process_without_the_library_respects_the_lock(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "lock"
    lock = FileLock(path, refusal=str)
    file = os.open(path, os.O_RDWR)
    with pytest.raises(BlockingIOError):
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    lock.release()
    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    os.close(file)


def test_another_thread_can_let_go_of_a_lock(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    lock = FileLock(path, refusal=str)
    releasing = threading.Thread(target=lock.release)
    releasing.start()
    releasing.join()
    assert not is_locked(path)
    FileLock(path, refusal=str).release()


def test_the_file_is_for_its_owner_only_whatever_the_umask(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    before = os.umask(0)
    try:
        FileLock(path, refusal=str).release()
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_what_workers_import_does_not_bring_the_hooks_of_every_fork() -> None:
    code = "import sys, drivora_service.worker.performing; print('filelock' in sys.modules)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "False"


def test_a_file_system_without_locks_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "one.lock"
    path.touch()

    def flock(_file: int, _operation: int) -> None:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))

    monkeypatch.setattr(fcntl, "flock", flock)
    message = f"the file system of {tmp_path} cannot lock files .* choose another folder"
    with pytest.raises(StoreError, match=message):
        FileLock(path, refusal=str)
    with pytest.raises(StoreError, match=message):
        is_locked(path)
