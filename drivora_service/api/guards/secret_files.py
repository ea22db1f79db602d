"""Files with hashes of secrets: read again when they change, replaced as a whole, private."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from filelock import UnixFileLock

from drivora_service.errors import StoreError


@dataclass(frozen=True, slots=True)
class FileVersion:
    """What differs between two contents of a file that is replaced as a whole."""

    mtime_ns: int
    inode: int
    size: int

    UNKNOWN: ClassVar[FileVersion]
    """Of a file that cannot be looked at."""

    @classmethod
    def of(cls, path: Path) -> FileVersion | None:
        """Returns the version of a file; ``None``: it does not exist.

        Raises:
            OSError: It cannot be looked at.
        """
        try:
            status = path.stat()
        except FileNotFoundError:
            return None
        return cls(status.st_mtime_ns, status.st_ino, status.st_size)


FileVersion.UNKNOWN = FileVersion(-1, -1, -1)


@contextmanager
def secret_file(path: Path) -> Iterator[None]:
    """Keeps other processes from changing a file meanwhile.

    Raises:
        StoreError: Its folder cannot be written.
    """
    lock = UnixFileLock(path.with_suffix(".lock"), thread_local=False, mode=0o600)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except OSError as error:
        raise _not_written(path, error) from error
    try:
        yield
    finally:
        lock.release()


def write_secret_file(path: Path, content: bytes) -> None:
    """Replaces a file by one with other content that its owner only may read.

    After a power failure it has either content as a whole.

    Raises:
        StoreError: It cannot be written; it is as it was.
    """
    name = ""
    try:
        # Its mode is 0600 from the beginning.
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(name).replace(path)
    except OSError as error:
        if name:
            with contextlib.suppress(OSError):
                Path(name).unlink()
        raise _not_written(path, error) from error
    with contextlib.suppress(OSError):
        _sync_folder(path.parent)


def _sync_folder(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _not_written(path: Path, error: OSError) -> StoreError:
    return StoreError(
        f"{path} cannot be written: {error.strerror or error}. It is as it was; free space there, "
        "or let this account write there, and try again"
    )
