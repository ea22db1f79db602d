"""Ending a worker with the process that owns it, however that process dies."""

from __future__ import annotations

import ctypes
import fcntl
import multiprocessing
import os
import platform
import signal
import threading
from collections.abc import Sequence
from multiprocessing.connection import wait

_PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Arranges that this process is killed when its owner dies, also by ``SIGKILL``.

    The owner holds the other end of a pipe. On Linux the kernel sends the signal when that is
    closed (``F_SETSIG`` in ``fcntl(2)``), even if native code here never releases the interpreter
    lock. Elsewhere a thread waits for it.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    if platform.system() == "Linux":
        # Not the kernel's parent-death signal: the parent is a fork server, which lives as long as
        # any of its children.
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(parent.sentinel, fcntl.F_SETSIG, int(signal.SIGKILL))
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)
        if wait([parent.sentinel], 0):
            os._exit(1)
        return
    _die_when_ready([parent.sentinel])


def die_with_keeper(keeper: int, lifeline: int) -> None:
    """Arranges that this process, a worker, is killed when its keeper dies or the server does.

    Args:
        keeper: Process id of the keeper, which has forked this process.
        lifeline: Reading end of a pipe; only the keeper holds the other end.
    """
    if platform.system() == "Linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)
        if os.getppid() != keeper:
            os._exit(1)
    else:
        _die_when_ready([lifeline])
    die_with_parent()


def _die_when_ready(files: Sequence[int]) -> None:
    def watch() -> None:
        wait(files)
        os._exit(1)

    threading.Thread(target=watch, name="parent-watch", daemon=True).start()
