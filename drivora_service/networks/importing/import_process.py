"""The process that reads one uploaded file: ``python -P -m`` this module, with its order as JSON.

It sets its limits before it reads the file, and ends with the process that has started it.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import resource
import signal
import sys
import threading
import time
from pathlib import Path
from types import FrameType

from drivora_service.errors import DrivoraError
from drivora_service.networks.importing.import_order import (
    ENDING_S,
    MADE,
    RESULT,
    SOURCE,
    ImportOrder,
    ImportResult,
    too_much_memory,
)
from drivora_service.networks.importing.netconvert import MAX_SECONDS
from drivora_service.networks.importing.network_importing import make_network
from drivora_service.shapes import adapter, to_json

_PR_SET_NO_NEW_PRIVS = 38
_NICENESS = 10
_OPEN_FILES = 64

_STORAGE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS})
"""Errors of the storage, which are no fault of the file."""


def main() -> None:
    """Imports the file in the current folder, and writes the result beside it."""
    order = adapter(ImportOrder).validate_json(sys.argv[1])
    signal.signal(signal.SIGTERM, _exit_on_signal)
    # Before the limits: one that lacks memory to begin would be waited for.
    threading.Thread(target=_end_with_parent, name="parent-watch", daemon=True).start()
    _confine(order)
    try:
        result = _result(order)
    except MemoryError:
        result = ImportResult(refusal=too_much_memory(order.limits))
    Path(RESULT).write_bytes(to_json(ImportResult, result))


def _result(order: ImportOrder) -> ImportResult:
    try:
        make_network(
            Path(SOURCE).read_bytes(),
            order.format,
            order.name,
            Path(MADE),
            called="the file",
            origin="an uploaded file",
            max_seconds=MAX_SECONDS,
        )
    except DrivoraError as error:
        # The names of folders are of no concern to a client.
        return ImportResult(refusal=str(error).replace(f"{Path.cwd()}/", ""))
    except OSError as error:
        if error.errno in _STORAGE:
            return ImportResult(storage_fault=str(error.strerror))
        return ImportResult(refusal=f"the network cannot be written: {error.strerror}")
    return ImportResult()


def _confine(order: ImportOrder) -> None:
    """Sets the limits of this process and of those that it starts."""
    limits = order.limits
    # Python may never end once the smallest piece of memory is refused to it. So the parent ends
    # this process before; this limit is for what grows faster than the parent looks.
    beyond = limits.memory_bytes + limits.memory_bytes // 4
    memory = beyond, max(beyond, limits.conversion_memory_bytes)
    for what, soft, most in (
        (resource.RLIMIT_CORE, 0, 0),
        (resource.RLIMIT_NOFILE, _OPEN_FILES, _OPEN_FILES),
        (resource.RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes),
        (resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 5),
        (resource.RLIMIT_AS, *memory),
    ):
        _, hard = resource.getrlimit(what)
        allowed = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (min(soft, allowed), allowed))
    # Runs and requests come first, and so they do where memory is short.
    os.nice(_NICENESS)
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


def _end_with_parent() -> None:
    """Ends this process and netconvert once the parent has gone, which closes the input."""
    with contextlib.suppress(OSError):
        os.read(0, 1)
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(ENDING_S)
    os.killpg(0, signal.SIGKILL)


def _exit_on_signal(_number: int, _frame: FrameType | None) -> None:
    """Ends the main thread where it is, which ends netconvert and removes its files."""
    sys.exit(1)


if __name__ == "__main__":
    main()
