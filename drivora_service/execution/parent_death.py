"""A worker must not outlive the process that owns it, however that one dies."""

from __future__ import annotations

import fcntl
import multiprocessing
import os
import platform
import signal
import threading
from multiprocessing.connection import wait


def die_with_parent() -> None:
    """Arranges that this process is killed when the one that owns it dies, also by ``SIGKILL``.

    The owner holds the other end of a pipe. On Linux the kernel sends the signal when that is
    closed (``F_SETSIG`` in ``fcntl(2)``), even if native code here never lets go of the
    interpreter. Elsewhere a thread waits for it.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    if platform.system() == "Linux":
        # Not the kernel's death signal of parents: a fork server lies between, which lives as long
        # as any of its children do.
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(parent.sentinel, fcntl.F_SETSIG, int(signal.SIGKILL))
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)
        if wait([parent.sentinel], 0):
            os._exit(1)
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="parent-watch", daemon=True).start()
