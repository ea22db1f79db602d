"""Files with hashes of secrets: read again when they change, replaced as a whole, private."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from filelock import UnixFileLock

from drivora_service.errors import StoreError

_MOST_BYTES = 16 << 20
"""Of a file: more than all sessions of a busy service, and no burden for its memory."""


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
            if path.is_symlink():
                # Its place is not mounted, perhaps. A service must not take that for no tokens.
                raise OSError(errno.ENOENT, "it is a link to a file that does not exist") from None
            return None
        return cls(status.st_mtime_ns, status.st_ino, status.st_size)


FileVersion.UNKNOWN = FileVersion(-1, -1, -1)


def read_secret_file(path: Path) -> bytes:
    """Returns the content of a file, without waiting for a pipe or reading a device.

    Raises:
        OSError: It cannot be read, or is no file of a usual size.
    """
    # Without O_NONBLOCK, a pipe would keep the service waiting until another process writes to it.
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not stat.S_ISREG(status.st_mode):
            raise OSError(errno.EINVAL, "it is a pipe, a device or a socket")
        if status.st_size > _MOST_BYTES:
            raise OSError(errno.EFBIG, f"it has {status.st_size} bytes, more than {_MOST_BYTES}")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            return file.read()
    finally:
        os.close(descriptor)


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
