"""Copies on this machine of trace files that are in a storage of other machines."""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import shutil
import stat
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

MOST_COPIES = 1000
"""Copies that are kept on this machine; one is some hundred kilobytes."""


class TraceCopies:
    """A folder of copies, the newest of which are kept; used by several threads and processes."""

    def __init__(self, folder: Path) -> None:
        """Takes the folder, which need not exist yet."""
        self._folder = folder
        self._forgetting = threading.Lock()
        self._states: dict[Path, tuple[int, ...]] = {}

    def place_of_none(self, name: str) -> Path:
        """Returns a path at which there never is a copy, for a file that does not exist."""
        return self._folder / "none" / name.rpartition("/")[2]

    def get(
        self,
        name: str,
        version: str,
        fetch: Callable[[str], object],
        *,
        size: int | None,
        written: float,
    ) -> Path:
        """Returns the path of a copy, which is made unless there is one that is whole.

        Args:
            name: Name of the file in the storage.
            version: Text that changes with the file.
            fetch: Writes the file to a path.
            size: Its size in bytes, if that is known.
            written: When it was written, in seconds since 1970; infinite if that is not known.

        Raises:
            FileNotFoundError: It was removed meanwhile.
            OSError: It cannot be fetched or written.
        """
        digest = hashlib.sha256(f"{name} {version}".encode()).hexdigest()
        # It ends with the name of the file, which clients see.
        path = self._folder / digest[:32] / name.rpartition("/")[2]
        if self._is_whole(path, size):
            os.utime(path.parent)
            return path
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(dir=path.parent, suffix=".part")
        os.close(handle)
        try:
            fetch(part)
            if math.isfinite(written):
                # Messages on a damaged trace say when it was written, not when it was copied.
                os.utime(part, (written, written))
            if path.is_dir():
                shutil.rmtree(path)
            Path(part).replace(path)
            self._states[path] = _state(path.stat())
        finally:
            Path(part).unlink(missing_ok=True)
        self._forget_oldest()
        return path

    def _is_whole(self, path: Path, size: int | None) -> bool:
        """Returns whether there is a copy that has not changed since it was made.

        Of one that another process made only the size is compared. The hash of its trace is
        checked all the same when it is read; a damaged copy would hide a trace that is whole.
        """
        try:
            found = path.stat()
        except OSError:
            return False
        if not stat.S_ISREG(found.st_mode) or size not in (None, found.st_size):
            return False
        return self._states.get(path, _state(found)) == _state(found)

    def _forget_oldest(self) -> None:
        with self._forgetting:
            copies = [path for path in self._folder.iterdir() if path.is_dir()]
            if len(copies) <= MOST_COPIES:
                return
            copies.sort(key=_last_use)
            for path in copies[: len(copies) // 2]:
                shutil.rmtree(path, ignore_errors=True)
            # Other threads make copies meanwhile.
            for path in tuple(self._states):
                if not path.exists():
                    self._states.pop(path, None)


def _state(found: os.stat_result) -> tuple[int, ...]:
    return found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


def _last_use(path: Path) -> float:
    # Another server that shares the folder may have removed it.
    with contextlib.suppress(FileNotFoundError):
        return path.stat().st_mtime
    return 0.0
