"""The output of a worker, in a file of bounded size that only its slot opens by name."""

from __future__ import annotations

import contextlib
import os
import stat
import threading
from pathlib import Path

_TAIL_BYTES = 16_384
_TAIL_LINES = 40
_KEPT_BYTES = 256 << 10
"""Bytes at the end of a log that are kept when it is cut."""
_MODE = 0o600


class WorkerLog:
    """The log of a slot's workers.

    Code under test may write anything to the file, and may replace it: the slot opens no file that
    it has not made itself. Another thread may cut the log at any time.
    """

    def __init__(self, path: Path, *, longest: int) -> None:
        """Creates the log; :meth:`open` creates its file.

        Args:
            path: Path of the file.
            longest: Bytes beyond which it is cut.
        """
        self._path, self._longest = path, longest
        self._file = -1
        self._begin = 0
        self._changing = threading.RLock()

    def open(self) -> int:
        """Creates the file, unless it exists; returns its descriptor, which the log owns.

        Raises:
            OSError: It cannot be made.
        """
        with self._changing:
            if self._file >= 0 and not self._is_in_place():
                self.close()
            if self._file < 0:
                self._path.parent.mkdir(parents=True, exist_ok=True)
                with contextlib.suppress(FileNotFoundError):
                    self._path.unlink()
                flags = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
                self._file = os.open(self._path, flags, _MODE)
            return self._file

    def _is_in_place(self) -> bool:
        try:
            named, ours = os.lstat(self._path), os.fstat(self._file)
        except OSError:
            return False
        same = (named.st_dev, named.st_ino) == (ours.st_dev, ours.st_ino)
        return same and stat.S_ISREG(ours.st_mode)

    def mark(self) -> None:
        """Makes :meth:`tail` begin with the output after this call."""
        with self._changing:
            self._begin = self._size()

    def begin_run(self) -> None:
        """Cuts the log if it is too long, and makes :meth:`tail` begin with what follows."""
        with self._changing:
            self._begin = self.cut()

    def size(self) -> int:
        """Returns the number of bytes of the log."""
        with self._changing:
            return self._size()

    def _size(self) -> int:
        return 0 if self._file < 0 else os.fstat(self._file).st_size

    def tail(self) -> str:
        """Returns the last lines printed since the mark."""
        with self._changing:
            end = self._size()
            begin = max(self._begin if self._begin <= end else 0, end - _TAIL_BYTES)
            text = os.pread(self._file, end - begin, begin) if end > begin else b""
        return "\n".join(text.decode(errors="replace").splitlines()[-_TAIL_LINES:])

    def cut(self) -> int:
        """Keeps only the end of a log that is too long, with a line that says so.

        Returns:
            The number of bytes of the log.
        """
        with self._changing:
            size = self._size()
            if size <= self._longest:
                return size
            # Waits until a write that is under way has ended, as the truncation would: otherwise
            # its end, such as the last words of a process, would be cut unread.
            os.fchmod(self._file, _MODE)
            size = self._size()
            kept = os.pread(self._file, _KEPT_BYTES, size - _KEPT_BYTES)
            os.ftruncate(self._file, 0)
            line = f"[the log grew beyond {self._longest} bytes; only its end was kept]\n".encode()
            os.write(self._file, line + kept)
            self._begin = 0
            return self._size()

    def note(self, text: str) -> None:
        """Adds a line of the slot's own."""
        with self._changing:
            if self._file >= 0:
                os.write(self._file, f"[{text}]\n".encode(errors="replace"))

    def close(self) -> None:
        """Closes the file, which is kept."""
        with self._changing:
            if self._file >= 0:
                os.close(self._file)
            self._file = -1
            self._begin = 0
